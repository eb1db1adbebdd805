#include "recollect/cnn/device.h"

#include <optional>

#include "recollect/core/error.h"

namespace recollect::cnn {
namespace {

std::optional<torch::Device> Parsed(const std::string& name) {
  try {
    return torch::Device(name);
  } catch (const c10::Error&) {
    return std::nullopt;
  }
}

}  // namespace

torch::Device DeviceNamed(const std::string& name, int rank) {
  const auto cards = static_cast<int>(torch::cuda::device_count());
  if (name.empty()) {
    if (cards == 0) return torch::kCPU;
    return {torch::kCUDA, static_cast<c10::DeviceIndex>(rank % cards)};
  }
  const std::optional<torch::Device> device = Parsed(name);
  Require(device.has_value(), "device", fmt::format("'{}' is not one of cpu, cuda, cuda:N", name));
  Require(!device->is_cuda() || std::max<int>(device->index(), 0) < cards, "device",
          fmt::format("'{}' is not there: libtorch sees {} graphics cards", name, cards),
          "leave --device out, or take cpu");
  return *device;
}

}  // namespace recollect::cnn
