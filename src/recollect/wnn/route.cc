#include "recollect/wnn/route.h"

#include <algorithm>

#include "recollect/core/error.h"

namespace recollect::wnn {
namespace {

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

int Supported(const Route& route, std::span<const LabelVotes> histogram) {
  if (histogram.empty()) return -1;
  const std::vector<double> support = Support(route, histogram);
  const auto place =
      static_cast<int>(std::max_element(support.begin(), support.end()) - support.begin());
  int best = place;
  double most = 0;
  for (const LabelVotes& one : histogram) {
    if (one.label == place) most = Standing(one);
  }
  for (const LabelVotes& one : histogram) {
    if (Standing(one) <= most || !route.WithinOne(place, one.label)) continue;
    most = Standing(one);
    best = one.label;
  }
  return best;
}

}  // namespace recollect::wnn
