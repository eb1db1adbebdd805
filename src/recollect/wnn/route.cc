#include "recollect/wnn/route.h"

#include <algorithm>
#include <cmath>

#include "recollect/core/error.h"
#include "recollect/wnn/zoom.h"

namespace recollect::wnn {
namespace {

constexpr double kBelieved = 0.05;  // power of a belief beside that of votes

std::vector<double> VotesByPlace(const Route& route, std::span<const LabelVotes> histogram) {
  std::vector<double> votes(route.next.size(), 0);
  for (const LabelVotes& one : histogram) {
    Require(one.label >= 0 && one.label < route.places(), "route", "a vote for no place of it");
    votes[static_cast<std::size_t>(one.label)] = one.votes;
  }
  return votes;
}

}  // namespace

bool Route::WithinOne(int a, int b) const {
  const auto near = [&](int p) {
    const auto i = static_cast<std::size_t>(p);
    return p == b || next[i] == b || before[i] == b;
  };
  if (a < 0 || b < 0) return false;
  const auto& others = beside[static_cast<std::size_t>(a)];
  return near(a) || std::any_of(others.begin(), others.end(), near);
}

Route ChainRoute(int places) {
  Route route;
  for (int i = 0; i < places; ++i) {
    route.next.push_back(i + 1 < places ? i + 1 : -1);
    route.before.push_back(i - 1);
  }
  route.beside.resize(static_cast<std::size_t>(places));
  for (int i = 0; i < places; ++i) {
    auto& along = route.along.emplace_back();
    for (int j = std::max(0, i - 2); j <= std::min(places - 1, i + 2); ++j) {
      along.push_back({j, static_cast<double>(j - i)});
    }
  }
  return route;
}

std::vector<double> Support(const Route& route, std::span<const LabelVotes> histogram) {
  const std::vector<double> votes = VotesByPlace(route, histogram);
  std::vector<double> support(votes.size(), 0);
  const auto spread = [&](std::size_t to, double own) {
    support[to] += own;
    if (route.next[to] >= 0) support[static_cast<std::size_t>(route.next[to])] += own / 2;
    if (route.before[to] >= 0) support[static_cast<std::size_t>(route.before[to])] += own / 2;
  };
  for (const LabelVotes& one : histogram) {
    const auto i = static_cast<std::size_t>(one.label);
    spread(i, votes[i]);
    for (const int other : route.beside[i]) spread(static_cast<std::size_t>(other), votes[i]);
  }
  return support;
}

std::vector<double> Steadiness(const Route& route, std::span<const LabelVotes> histogram) {
  std::vector<Zoom> zooms(route.next.size());
  for (const LabelVotes& one : histogram) zooms[static_cast<std::size_t>(one.label)] = one.zoom;
  const auto seen_by = [&](int place) {
    return place < 0 ? Zoom{} : zooms[static_cast<std::size_t>(place)];
  };
  std::vector<double> steadiness;
  std::vector<ZoomAlong> along;
  for (const LabelVotes& one : histogram) {
    const auto i = static_cast<std::size_t>(one.label);
    along.clear();
    for (const auto& [place, places] : route.along[i]) along.push_back({places, seen_by(place)});
    steadiness.push_back(Steady(along, seen_by(route.before[i]), one.zoom, seen_by(route.next[i])));
  }
  return steadiness;
}

int Supported(const Route& route, std::span<const LabelVotes> histogram) {
  if (histogram.empty()) return -1;
  const std::vector<double> support = Support(route, histogram);
  const auto place =
      static_cast<int>(std::max_element(support.begin(), support.end()) - support.begin());
  return Outstanding(route, place, histogram);
}

int Outstanding(const Route& route, int place, std::span<const LabelVotes> histogram,
                std::span<const double> belief) {
  const std::vector<double> steadiness = Steadiness(route, histogram);
  int best = place;
  double most = 0;
  for (std::size_t i = 0; i < histogram.size(); ++i) {
    const int label = histogram[i].label;
    double standing = histogram[i].votes * steadiness[i] * steadiness[i];
    if (!belief.empty()) standing *= std::pow(belief[static_cast<std::size_t>(label)], kBelieved);
    // Of equals the place itself.
    const bool more = standing > most || (standing == most && label == place);
    if (!more || !route.WithinOne(place, label)) continue;
    most = standing;
    best = label;
  }
  return best;
}

}  // namespace recollect::wnn
