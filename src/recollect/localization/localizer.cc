#include "recollect/localization/localizer.h"

#include "recollect/core/error.h"
#include "recollect/core/stopwatch.h"
#include "recollect/wnn/displaced.h"

namespace recollect {

Localizer::Localizer(const Map& map, cnn::PoseNetwork network, ThreadPool& pool,
                     const wnn::SearchOptions& search)
    : map_(map),
      network_(std::move(network)),
      pool_(pool),
      search_(search),
      encoder_(map.description().network, map.description().camera.left.width,
               map.description().camera.left.height, pool) {
  Require(map.size() > 0, "map", "has no key frames");
}

Localization Localizer::Localize(const cv::Mat& image, const std::string& name) {
  Localization answer;
  Stopwatch step, whole;

  // Section III-A: the committee of neurons recollects the most similar key frame.
  const wnn::Recollection recollection = Recollect(image, name);
  answer.key_frame = recollection.winner;
  answer.confidence = recollection.confidence;
  answer.ms.recollect = step.Milliseconds();

  step.Restart();
  const KeyFrame key_frame = map_.At(answer.key_frame);
  const cv::Mat key_image = map_.Image(answer.key_frame);
  answer.ms.key_frame = step.Milliseconds();

  // Section III-B: the siamese network regresses the live camera's pose in the key frame's.
  step.Restart();
  answer.keyframe_from_live = Relate(image, key_image);
  answer.ms.relate = step.Milliseconds();

  // Section III: G_L = G_K T(delta).
  answer.world_from_camera = key_frame.world_from_camera * answer.keyframe_from_live;
  answer.ms.total = whole.Milliseconds();
  return answer;
}

wnn::Recollection Localizer::Recollect(const cv::Mat& image, const std::string& name) {
  const PinholeCamera& camera = map_.description().camera.left;
  Require(image.type() == CV_8UC3 && image.cols == camera.width && image.rows == camera.height,
          name,
          fmt::format("is {}x{} with {} channels, the map's are {}x{} in colour", image.cols,
                      image.rows, image.channels(), camera.width, camera.height),
          "localise with the camera that made the map");
  const wnn::ImageView view{image.data, image.cols, image.rows, 3,
                            static_cast<std::ptrdiff_t>(image.step)};
  return wnn::RecollectImage(map_.memory(), encoder_, view, pool_, search_);
}

SE3 Localizer::Relate(const cv::Mat& live, const cv::Mat& key_frame) {
  const cnn::Crop& crop = network_.crop();
  return network_.KeyframeFromLive(crop.Apply(live, "live image"),
                                   crop.Apply(key_frame, "key frame"));
}

}  // namespace recollect
