#include "recollect/simulation/faults.h"

#include <array>
#include <charconv>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "recollect/core/error.h"
#include "recollect/core/random.h"

namespace recollect::simulation {
namespace {

constexpr std::array<std::pair<Fault, const char*>, 7> kNames = {
    {{Fault::kNone, "none"},
     {Fault::kDropped, "dropped"},
     {Fault::kFrozen, "frozen"},
     {Fault::kBlack, "black"},
     {Fault::kOverexposed, "overexposed"},
     {Fault::kHalfOccluded, "occluded"},
     {Fault::kBlurred, "blurred"}}};
constexpr double kUsualShare = 0.02;
constexpr double kOverexposure = 3;  // of a picture's values, which are no longer linear in light
constexpr std::int64_t kRun = 3;     // frames that share a fault

}  // namespace

std::string Name(Fault fault) {
  for (const auto& [known, name] : kNames) {
    if (known == fault) return name;
  }
  return "?";
}

FaultPlan ParseFaults(std::string_view text) {
  FaultPlan plan;
  if (text.empty() || text == "none") return plan;
  if (text == "all") {
    for (const auto& [fault, name] : kNames) {
      if (fault != Fault::kNone) plan.entries.push_back({fault, kUsualShare});
    }
    return plan;
  }
  double sum = 0;
  while (!text.empty()) {
    const std::string_view item = text.substr(0, text.find(','));
    text.remove_prefix(std::min(text.size(), item.size() + 1));
    const std::string_view name = item.substr(0, item.find('='));
    FaultPlan::Entry entry{Fault::kNone, kUsualShare};
    for (const auto& [fault, known] : kNames) {
      if (name == known) entry.fault = fault;
    }
    Require(entry.fault != Fault::kNone, "faults", fmt::format("'{}' is not known", name),
            "take dropped, frozen, black, overexposed, occluded, blurred, all or none");
    if (name.size() < item.size()) {
      const std::string_view number = item.substr(name.size() + 1);
      const auto [end, error] =
          std::from_chars(number.data(), number.data() + number.size(), entry.share);
      Require(error == std::errc() && end == number.data() + number.size() && entry.share >= 0 &&
                  entry.share <= 0.9,
              "faults", fmt::format("'{}' is no share between 0 and 0.9", number));
    }
    sum += entry.share;
    plan.entries.push_back(entry);
  }
  Require(sum <= 0.9, "faults", fmt::format("the shares sum to {:.2f}", sum),
          "keep them below 0.9");
  return plan;
}

Fault FaultOf(const FaultPlan& plan, std::int64_t frame, std::uint64_t seed) {
  if (frame == 0) return Fault::kNone;  // something must be there to freeze
  Random random(SubSeed(SubSeed(seed, 0xfa), static_cast<std::uint64_t>(frame / kRun)));
  double u = random.Uniform();
  for (const auto& [fault, share] : plan.entries) {
    if (u < share) return fault;
    u -= share;
  }
  return Fault::kNone;
}

void Spoil(Fault fault, std::uint64_t seed, cv::Mat& image) {
  Random random(SubSeed(seed, 0x5b));
  if (fault == Fault::kBlack) {
    image *= 0.02;
  } else if (fault == Fault::kBlurred) {
    cv::GaussianBlur(image, image, {}, random.Uniform(3, 7));
  } else if (fault == Fault::kHalfOccluded) {  // something stuck to the lens, out of focus
    cv::Mat1f clear(image.size(), 1.0F);
    const bool left = random.Uniform() < 0.5;
    const int half = image.cols / 2;
    clear(cv::Rect(left ? 0 : half, 0, half, image.rows)).setTo(0.04F);
    cv::GaussianBlur(clear, clear, {}, image.cols / 40.0);
    for (int y = 0; y < image.rows; ++y) {
      for (int x = 0; x < image.cols; ++x) {
        auto& pixel = image.at<cv::Vec3b>(y, x);
        for (int k = 0; k < 3; ++k) {
          pixel[k] = cv::saturate_cast<std::uint8_t>(static_cast<float>(pixel[k]) * clear(y, x));
        }
      }
    }
  }
}

std::string FaultyCamera::Take(cv::Mat& image) {
  const std::int64_t frame = frame_++;
  const Fault fault = FaultOf(plan_, frame, seed_);
  if (fault == Fault::kFrozen) {
    image = good_.clone();
  } else if (fault == Fault::kOverexposed) {
    image *= kOverexposure;
  } else {
    Spoil(fault, SubSeed(seed_, static_cast<std::uint64_t>(frame)), image);
  }
  if (fault != Fault::kFrozen) good_ = image.clone();
  return Name(fault == Fault::kDropped ? Fault::kNone : fault);
}

}  // namespace recollect::simulation
