#include <algorithm>
#include <opencv2/imgcodecs.hpp>
#include <optional>

#include "recollect/core/error.h"
#include "recollect/core/files.h"
#include "recollect/core/parallel.h"
#include "recollect/dataset/image.h"
#include "recollect/dataset/sampling.h"
#include "recollect/map/map.h"
#include "recollect/map/records.h"
#include "recollect/wnn/encoder.h"

namespace recollect {
namespace {

// Blocks written between two commits of a map under construction: bounds memory, not safety.
constexpr int kBlocksPerCommit = 16;
constexpr int kJpegQuality = 95;
constexpr std::size_t kFramesAhead = 16;  // whose geometry is made at a time

// A lap's frames that become key frames.
struct Selection {
  const Lap* lap;
  std::vector<std::size_t> frames;
};

// Checks the laps against the map and against each other, before anything is written.
std::vector<Selection> Select(std::span<const Lap> laps, const MapDescription& description) {
  const PinholeCamera& camera = description.camera.left;
  std::vector<std::string> names;
  for (const MapLap& lap : description.laps) names.push_back(lap.name);
  std::vector<Selection> selections;
  for (const Lap& lap : laps) {
    const std::string where = lap.folder.string();
    Require(std::find(names.begin(), names.end(), lap.name) == names.end(), where,
            fmt::format("a lap named '{}' is in the map already", lap.name),
            "give its folder another name");
    names.push_back(lap.name);
    const PinholeCamera& own = lap.camera.left;
    Require(own.width == camera.width && own.height == camera.height, where,
            fmt::format("its images are {}x{}, the map's {}x{}", own.width, own.height,
                        camera.width, camera.height),
            "a map has images of one size");
    selections.push_back({&lap, SampleFrames(lap, description.spacing_m)});
    for (const std::size_t frame : selections.back().frames) {
      Require(!lap.frames[frame].left.empty(), where, fmt::format("frame {} has no image", frame),
              "a map needs images, not poses alone");
    }
  }
  return selections;
}

// The image as the map keeps it: a JPEG file as it is, others as JPEG.
std::vector<std::byte> EncodeImage(const std::filesystem::path& file, const cv::Mat& image) {
  const std::string extension = file.extension().string();
  if (extension == ".jpg" || extension == ".jpeg") {
    const std::string content = ReadFile(file);
    const Bytes bytes = std::as_bytes(std::span(content));
    return {bytes.begin(), bytes.end()};
  }
  std::vector<std::uint8_t> jpeg;
  cv::imencode(".jpg", image, jpeg, {cv::IMWRITE_JPEG_QUALITY, kJpegQuality});
  const Bytes bytes = std::as_bytes(std::span(jpeg));
  return {bytes.begin(), bytes.end()};
}

// Appends patterns to a store block by block, the last one as small as its frames allow.
class PatternAppender {
 public:
  PatternAppender(StoreWriter& writer, int neurons, int key_frames, const std::string& where)
      : writer_(writer), neurons_(neurons), block_(wnn::BlockWords(neurons)) {
    number_ = static_cast<std::uint32_t>(key_frames / wnn::kBlockFrames);
    if (key_frames % wnn::kBlockFrames == 0) return;
    const auto last = writer_.Get(Table::kPatterns, number_);
    Require(last.has_value(), where, "the last block of the patterns is missing");
    const wnn::BlockView view = ViewOfBlock(*last, number_, key_frames, neurons, where);
    std::vector<std::uint64_t> pattern(wnn::BlockWords(neurons, 1));
    for (; frames_ < view.frames; ++frames_) {
      wnn::LoadFrame(view, frames_, pattern);
      wnn::StoreFrame(pattern, frames_, wnn::kBlockFrames, block_.data());
    }
  }

  // Returns true when this filled and wrote a block.
  bool Append(std::span<const std::uint64_t> pattern) {
    wnn::StoreFrame(pattern, frames_++, wnn::kBlockFrames, block_.data());
    if (frames_ < wnn::kBlockFrames) return false;
    writer_.Put(Table::kPatterns, number_++, std::as_bytes(std::span(block_)));
    frames_ = 0;
    return true;
  }

  void Finish() {
    if (frames_ == 0) return;
    const int capacity = (frames_ + 7) / 8 * 8;
    std::vector<std::uint64_t> small(wnn::BlockWords(neurons_, capacity));
    std::vector<std::uint64_t> pattern(wnn::BlockWords(neurons_, 1));
    const wnn::BlockView view{block_.data(), frames_, wnn::kBlockFrames};
    for (int frame = 0; frame < frames_; ++frame) {
      wnn::LoadFrame(view, frame, pattern);
      wnn::StoreFrame(pattern, frame, capacity, small.data());
    }
    writer_.Put(Table::kPatterns, number_, std::as_bytes(std::span(small)));
  }

 private:
  StoreWriter& writer_;
  int neurons_;
  std::vector<std::uint64_t> block_;
  std::uint32_t number_ = 0;  // of the block being filled
  int frames_ = 0;            // in it
};

// Writes the selected frames behind the key frames that are there, and the new description.
void Append(StoreWriter& writer, const std::string& where, MapDescription description,
            const std::vector<Selection>& selections, const GeometrySource& geometry,
            bool commit_as_it_goes, ThreadPool& pool, const ProgressSink& progress) {
  const PinholeCamera& camera = description.camera.left;
  wnn::Encoder encoder(description.network, camera.width, camera.height, pool);
  std::vector<std::uint64_t> pattern(encoder.pattern_words());
  auto key = static_cast<std::uint32_t>(description.KeyFrames());
  PatternAppender patterns(writer, description.network.neurons(), static_cast<int>(key), where);

  std::int64_t total = 0, done = 0;
  for (const Selection& selection : selections) {
    total += static_cast<std::int64_t>(selection.frames.size());
  }
  int blocks = 0;
  for (const Selection& selection : selections) {
    const Lap& lap = *selection.lap;
    const auto lap_number = static_cast<std::uint32_t>(description.laps.size());
    std::vector<std::vector<std::byte>> shapes;  // geometry of the frames from `ahead` on
    std::size_t ahead = 0;
    for (std::size_t i = 0; i < selection.frames.size(); ++i) {
      const std::size_t frame = selection.frames[i];
      if (geometry && i == ahead + shapes.size()) {
        ahead = i;
        shapes.assign(std::min(kFramesAhead, selection.frames.size() - i), {});
        pool.For(static_cast<std::int64_t>(shapes.size()), 1, [&](std::int64_t from, std::int64_t) {
          const auto at = static_cast<std::size_t>(from);
          shapes[at] = geometry(lap, selection.frames[ahead + at]);
        });
      }
      const cv::Mat image = ReadColour(lap.frames[frame].left);
      encoder.Encode(
          {image.data, image.cols, image.rows, 3, static_cast<std::ptrdiff_t>(image.step)},
          pattern);
      const KeyFrameRecord record = ToRecord({lap.WorldFromCamera(frame), lap.frames[frame].time,
                                              lap_number, static_cast<std::uint32_t>(frame)});
      writer.Put(Table::kKeyFrames, key, std::as_bytes(std::span(&record, 1)));
      writer.Put(Table::kImages, key, EncodeImage(lap.frames[frame].left, image));
      if (geometry) writer.Put(Table::kGeometry, key, shapes[i - ahead]);
      ++key;
      const bool filled = patterns.Append(pattern);
      if (filled && commit_as_it_goes && ++blocks % kBlocksPerCommit == 0) writer.Commit();
      Report(progress, "map", ++done, total, lap.name);
    }
    description.laps.push_back({lap.name, static_cast<int>(selection.frames.size())});
  }
  patterns.Finish();
  const std::string json = ToJson(description);
  writer.Put(kDescriptionKey, std::as_bytes(std::span(json)));
}

// Changes what a map says of itself.
void Describe(const std::filesystem::path& file,
              const std::function<void(MapDescription& description)>& change) {
  StoreWriter writer(file, /*create=*/false);
  MapDescription description = DescriptionFrom(writer.Get(kDescriptionKey), file.string());
  change(description);
  const std::string json = ToJson(description);
  writer.Put(kDescriptionKey, std::as_bytes(std::span(json)));
  writer.Commit();
}

}  // namespace

void CreateMap(const std::filesystem::path& file, std::span<const Lap> laps,
               const MapOptions& options, ThreadPool& pool, const ProgressSink& progress) {
  Require(!laps.empty(), file.string(), "no laps to make a map of");
  Require(options.spacing_m >= 0 && options.spacing_m < 1e6, "spacing",
          fmt::format("{} m is no distance between key frames", options.spacing_m));
  const Lap& first = laps.front();
  Require(first.camera.left.width > 0, first.folder.string(), "has no images or no calibration",
          "a map needs both");
  MapDescription description;
  description.camera = first.camera;
  description.body_from_camera = first.body_from_camera;
  description.world_up = first.world_up;
  description.spacing_m = options.spacing_m;
  description.network = options.network;
  const std::vector<Selection> selections = Select(laps, description);
  CreateStore(file, [&](StoreWriter& writer) {
    Append(writer, file.string(), description, selections, options.geometry,
           /*commit_as_it_goes=*/true, pool, progress);
  });
}

void AddToMap(const std::filesystem::path& file, std::span<const Lap> laps, ThreadPool& pool,
              const ProgressSink& progress, const GeometrySource& geometry) {
  StoreWriter writer(file, /*create=*/false);
  MapDescription description = DescriptionFrom(writer.Get(kDescriptionKey), file.string());
  description.recognition.reset();  // that was of another map
  const std::vector<Selection> selections = Select(laps, description);
  const bool has_geometry = writer.Get(Table::kGeometry, 0).has_value();
  Require(!has_geometry || geometry, file.string(),
          "its key frames have geometry, new ones have not", "say how geometry is made");
  Append(writer, file.string(), description, selections, has_geometry ? geometry : GeometrySource{},
         /*commit_as_it_goes=*/false, pool, progress);
  writer.Commit();
}

void SetGeometryInflation(const std::filesystem::path& file, double inflation) {
  Describe(file, [&](MapDescription& description) { description.geometry_inflation = inflation; });
}

void SetRecognition(const std::filesystem::path& file, const wnn::Calibration& calibration) {
  Describe(file, [&](MapDescription& description) { description.recognition = calibration; });
}

}  // namespace recollect
