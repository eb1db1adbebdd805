#include "recollect/depth/motion.h"

#include <cmath>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include "recollect/core/error.h"

namespace recollect {
namespace {

cv::Mat Gray(const cv::Mat& image, const PinholeCamera& camera) {
  Require((image.type() == CV_8UC1 || image.type() == CV_8UC3) && image.cols == camera.width &&
              image.rows == camera.height,
          "DepthFromMotion", "images must be 8 bit, gray or colour, of the camera's size");
  if (image.channels() == 1) return image;
  cv::Mat gray;
  cv::cvtColor(image, gray, cv::COLOR_BGR2GRAY);
  return gray;
}

cv::Mat Flow(const cv::Mat& from, const cv::Mat& to) {
  cv::Mat flow;
  cv::DISOpticalFlow::create(cv::DISOpticalFlow::PRESET_MEDIUM)->calc(from, to, flow);
  return flow;
}

// How far the flow there and back leads from the start; infinite where it leaves the image.
cv::Mat RoundTrip(const cv::Mat& there, const cv::Mat& back) {
  cv::Mat landing(there.size(), CV_32FC2);
  for (int v = 0; v < there.rows; ++v) {
    for (int u = 0; u < there.cols; ++u) {
      landing.at<cv::Point2f>(v, u) =
          cv::Point2f(static_cast<float>(u), static_cast<float>(v)) + there.at<cv::Point2f>(v, u);
    }
  }
  cv::Mat returned;
  cv::remap(back, returned, landing, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_CONSTANT,
            cv::Scalar(1e9, 1e9));
  cv::Mat miss = there + returned, parts[2], distance;
  cv::split(miss, parts);
  cv::magnitude(parts[0], parts[1], distance);
  return distance;
}

// The depth along `ray` of a point that the other camera sees in `seen`, or 0.
double Triangulate(const Eigen::Vector3d& ray, const Eigen::Vector2d& seen,
                   const SE3& other_from_image, const PinholeCamera& camera,
                   const MotionDepthOptions& options) {
  const Eigen::Vector3d turned = other_from_image.rotation() * ray;
  const Eigen::Vector3d& t = other_from_image.translation();
  if (turned.z() <= 0 || (camera.Project(turned) - seen).norm() < options.parallax_px) return 0;
  // (d turned + t) x (x, y, 1) = 0: two equations in d.
  const double x = (seen.x() - camera.cx) / camera.fx, y = (seen.y() - camera.cy) / camera.fy;
  const Eigen::Vector2d a(turned.x() - x * turned.z(), turned.y() - y * turned.z());
  const Eigen::Vector2d b(x * t.z() - t.x(), y * t.z() - t.y());
  const double depth = a.dot(b) / a.squaredNorm();
  if (!(depth >= options.nearest_m && depth <= options.farthest_m)) return 0;
  const Eigen::Vector3d there = depth * turned + t;
  const bool fits =
      there.z() > 0 && (camera.Project(there) - seen).norm() <= options.consistency_px;
  return fits ? depth : 0;
}

}  // namespace

cv::Mat DepthFromMotion(const cv::Mat& image, const cv::Mat& other, const SE3& other_from_image,
                        const PinholeCamera& camera, const MotionDepthOptions& options) {
  const cv::Mat from = Gray(image, camera), to = Gray(other, camera);
  const cv::Mat there = Flow(from, to);
  const cv::Mat miss = RoundTrip(there, Flow(to, from));
  cv::Mat depth = cv::Mat::zeros(image.size(), CV_32F);
  for (int v = 0; v < depth.rows; ++v) {
    for (int u = 0; u < depth.cols; ++u) {
      if (!(miss.at<float>(v, u) <= options.consistency_px)) continue;
      const cv::Point2f& flow = there.at<cv::Point2f>(v, u);
      const Eigen::Vector2d seen(u + static_cast<double>(flow.x), v + static_cast<double>(flow.y));
      depth.at<float>(v, u) = static_cast<float>(
          Triangulate(camera.Unproject(u, v, 1), seen, other_from_image, camera, options));
    }
  }
  return depth;
}

}  // namespace recollect
