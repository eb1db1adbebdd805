#include "recollect/cnn/network_kind.h"

#include <array>
#include <utility>

#include "recollect/cnn/compact_network.h"
#include "recollect/cnn/pair_network.h"
#include "recollect/cnn/paper_network.h"
#include "recollect/core/error.h"

namespace recollect::cnn {
namespace {

constexpr std::array<std::pair<NetworkKind, const char*>, 3> kNames = {
    {{NetworkKind::kPaperA, "a"}, {NetworkKind::kPaperB, "b"}, {NetworkKind::kCompact, "compact"}}};

}  // namespace

std::string Name(NetworkKind kind) {
  for (const auto& [candidate, name] : kNames) {
    if (candidate == kind) return name;
  }
  throw Error("network", "is of no known kind");
}

NetworkKind NetworkKindFromName(const std::string& name) {
  for (const auto& [kind, candidate] : kNames) {
    if (candidate == name) return kind;
  }
  throw Error("network", fmt::format("'{}' is not one of a, b, compact", name));
}

Crop DefaultCrop(NetworkKind kind, int image_width, int image_height) {
  return kind == NetworkKind::kCompact ? Crop::Compact(image_width, image_height)
                                       : Crop::Paper(image_width, image_height);
}

std::shared_ptr<PairNetwork> MakeNetwork(NetworkKind kind, const PinholeCamera& camera,
                                         bool covariance) {
  if (kind == NetworkKind::kCompact) return std::make_shared<CompactNetwork>(camera, covariance);
  Require(!covariance, "network", fmt::format("{} predicts no covariance", Name(kind)),
          "use network compact");
  return std::make_shared<PaperNetwork>(kind);
}

}  // namespace recollect::cnn
