#include "recollect/cnn/correspondence.h"

#include <gtest/gtest.h>

#include "recollect/cnn/gradient_check.h"
#include "recollect/cnn/layers.h"
#include "recollect/core/error.h"

namespace recollect::cnn {
namespace {

constexpr Grid kGrid{5, 7};

torch::Tensor Features(std::int64_t batch) {
  return torch::randn({batch, 4, kGrid.cells()}, torch::kDouble);
}

TEST(Correlate, IsSoftmaxOfProducts) {
  torch::manual_seed(3);
  const torch::Tensor live = Features(3), key = Features(3);
  const Correlation correlation = Correlate(live, key, kGrid);
  const torch::Tensor scores = torch::bmm(live.transpose(1, 2), key);
  EXPECT_TRUE(torch::allclose(correlation.total, scores.logsumexp(2)));
  const torch::Tensor best = scores.argmax(2);
  for (std::int64_t cell = 0; cell < kGrid.cells(); ++cell) {
    const auto column = correlation.columns[1][cell].item<std::int64_t>();
    const auto row = correlation.rows[1][cell].item<std::int64_t>();
    const auto top = best[1][cell].item<std::int64_t>();
    EXPECT_EQ(row, 2);  // five rows leave no other place for the window
    EXPECT_EQ(column, std::clamp<std::int64_t>(top % 7, 2, 4));
    for (int dy = -2; dy <= 2; ++dy) {
      for (int dx = -2; dx <= 2; ++dx) {
        EXPECT_NEAR(correlation.window[1][cell][5 * (dy + 2) + dx + 2].item<double>(),
                    scores[1][cell][7 * (row + dy) + column + dx].item<double>(), 1e-12);
      }
    }
  }
}

TEST(Correlate, GradientOfTotalAndWindow) {
  torch::manual_seed(4);
  ExpectGradients(
      [](const auto& in) {
        const Correlation c = Correlate(in[0], in[1], kGrid);
        return torch::cat({c.total.flatten(), c.window.flatten()});
      },
      {Features(2), Features(2)});
}

// Float has kernels of its own: they must give what double gives, over several blocks of cells and
// rows that fill no whole vectors.
TEST(Correlate, FloatEqualsDouble) {
  torch::manual_seed(5);
  const Grid grid{11, 17};
  const auto run = [&](const torch::Tensor& live, const torch::Tensor& key) {
    const torch::Tensor l = live.clone().requires_grad_(), k = key.clone().requires_grad_();
    const Correlation c = Correlate(l, k, grid);
    (c.total.square().sum() + c.window.sin().sum()).backward();
    return std::vector{c.total.detach(), c.window.detach(), l.grad(), k.grad()};
  };
  const torch::Tensor live = 2 * torch::randn({3, 8, grid.cells()}, torch::kDouble),
                      key = 2 * torch::randn({3, 8, grid.cells()}, torch::kDouble);
  const auto in_double = run(live, key),
             in_float = run(live.to(torch::kFloat), key.to(torch::kFloat));
  for (std::size_t i = 0; i < in_double.size(); ++i) {
    EXPECT_TRUE(torch::allclose(in_float[i].to(torch::kDouble), in_double[i], 1e-4, 1e-3)) << i;
  }
}

// The way that other devices go.
TEST(Correlate, ByTensorsIsTheSame) {
  const Grid grid{7, 9};
  const torch::Tensor live = torch::randn({2, 8, 63}, torch::kDouble),
                      key = torch::randn({2, 8, 63}, torch::kDouble);
  const Correlation expected = Correlate(live, key, grid);
  const Correlation got = CorrelateByTensors(live, key, grid);
  EXPECT_TRUE(torch::allclose(got.total, expected.total));
  EXPECT_TRUE(torch::allclose(got.window, expected.window));
  EXPECT_TRUE(torch::equal(got.columns, expected.columns));
  EXPECT_TRUE(torch::equal(got.rows, expected.rows));
}

TEST(Correlate, RefusesGridsSmallerThanItsWindow) {
  EXPECT_THROW(Correlate(torch::zeros({1, 2, 20}), torch::zeros({1, 2, 20}), {4, 5}), Error);
}

TEST(ReadPeaks, FindsAShiftBetweenCells) {
  // Features that are the cells' own places, sharply compared: the live image is the key frame,
  // seen 1.25 columns and 0.5 rows further.
  const Grid grid{12, 16};
  const auto features = [&](double columns, double rows) {
    const torch::Tensor cells = torch::arange(grid.cells(), torch::kDouble);
    const torch::Tensor x = cells.remainder(grid.columns) + columns;
    const torch::Tensor y = cells.div(grid.columns, "floor") + rows;
    return std::pair{x, y};
  };
  // exp(-|p - q|^2) = exp(2 p.q - p^2 - q^2); the live part's own square cancels in the softmax.
  const auto [x, y] = features(1.25, 0.5);
  const auto [u, v] = features(0, 0);
  const torch::Tensor ones = torch::ones_like(x);
  const torch::Tensor live = torch::stack({2 * x, 2 * y, ones}).unsqueeze(0);
  const torch::Tensor key = torch::stack({u, v, -u * u - v * v}).unsqueeze(0);
  const PeakFlow flow = ReadPeaks(Correlate(live, key, grid), grid);
  const std::int64_t cell = 5 * grid.columns + 7;
  EXPECT_NEAR(flow.displacement[0][0][cell].item<double>(), 1.25, 0.02);
  EXPECT_NEAR(flow.displacement[0][1][cell].item<double>(), 0.5, 0.02);
  EXPECT_NEAR(flow.share[0][0][cell].item<double>(), 1, 0.01);
}

TEST(ReadPeaks, Gradient) {
  torch::manual_seed(5);
  ExpectGradients(
      [](const auto& in) {
        const PeakFlow flow = ReadPeaks(Correlate(in[0], in[1], kGrid), kGrid);
        return torch::cat({flow.displacement, flow.share}, 1);
      },
      {Features(2), Features(2)});
}

TEST(ProjectCells, FollowsThePointsAndMarksWhatIsSeen) {
  const PinholeCamera camera{7, 5, 6, 6, 3, 2};
  const torch::Tensor rays = RayGrid(camera);
  const torch::Tensor points = Grid3d(torch::full({1, 5, 7}, 6.0), rays);
  torch::Tensor valid = torch::ones({1, 35}, torch::kBool);
  valid[0][16] = false;
  torch::Tensor motion = torch::zeros({1, 3, 4});
  motion[0].slice(1, 0, 3).copy_(torch::eye(3));
  motion[0][0][3] = 2.0;  // two cells at a depth of six
  const TrueFlow flow =
      ProjectCells(points, valid, motion, {5, 7}, camera.fx, camera.fy, camera.cx, camera.cy);
  EXPECT_NEAR(flow.columns[0][0].item<double>(), 2, 1e-5);
  EXPECT_NEAR(flow.rows[0][0].item<double>(), 0, 1e-5);
  EXPECT_TRUE(flow.visible[0][0].item<bool>());
  EXPECT_FALSE(flow.visible[0][6].item<bool>());   // leaves the key frame
  EXPECT_FALSE(flow.visible[0][16].item<bool>());  // depth unknown
}

class CorrespondenceLossTest : public ::testing::Test {
 protected:
  TrueFlow Truth() const {
    TrueFlow truth;
    truth.columns = torch::rand({2, kGrid.cells()}, torch::kDouble) * 6;
    truth.rows = torch::rand({2, kGrid.cells()}, torch::kDouble) * 4;
    truth.visible = torch::rand({2, kGrid.cells()}) > 0.3;
    return truth;
  }
};

TEST_F(CorrespondenceLossTest, IsTheCrossEntropyOfTheFourCellsAround) {
  torch::manual_seed(6);
  const torch::Tensor live = Features(2), key = Features(2);
  const TrueFlow truth = Truth();
  const torch::Tensor logs = torch::bmm(live.transpose(1, 2), key).log_softmax(2);
  double sum = 0, count = 0;
  for (std::int64_t b = 0; b < 2; ++b) {
    for (std::int64_t cell = 0; cell < kGrid.cells(); ++cell) {
      if (!truth.visible[b][cell].item<bool>()) continue;
      const double u = truth.columns[b][cell].item<double>();
      const double v = truth.rows[b][cell].item<double>();
      const auto left = std::min<std::int64_t>(static_cast<std::int64_t>(u), 5);
      const auto top = std::min<std::int64_t>(static_cast<std::int64_t>(v), 3);
      const double x = u - static_cast<double>(left), y = v - static_cast<double>(top);
      const auto log = [&](std::int64_t dy, std::int64_t dx) {
        return logs[b][cell][7 * (top + dy) + left + dx].item<double>();
      };
      sum -= (1 - x) * (1 - y) * log(0, 0) + x * (1 - y) * log(0, 1) + (1 - x) * y * log(1, 0) +
             x * y * log(1, 1);
      ++count;
    }
  }
  const torch::Tensor total = Correlate(live, key, kGrid).total;
  EXPECT_NEAR(CorrespondenceLoss(live, key, total, truth, kGrid).item<double>(), sum / count, 1e-9);
}

TEST_F(CorrespondenceLossTest, Gradient) {
  torch::manual_seed(7);
  const TrueFlow truth = Truth();
  ExpectGradients(
      [&](const auto& in) {
        return CorrespondenceLoss(in[0], in[1], Correlate(in[0], in[1], kGrid).total, truth, kGrid);
      },
      {Features(2), Features(2)});
}

TEST_F(CorrespondenceLossTest, IsZeroWhereNothingIsVisible) {
  const torch::Tensor live = Features(2);
  TrueFlow truth = Truth();
  truth.visible = torch::zeros_like(truth.visible);
  const torch::Tensor total = Correlate(live, live, kGrid).total;
  EXPECT_EQ(CorrespondenceLoss(live, live, total, truth, kGrid).item<double>(), 0);
}

}  // namespace
}  // namespace recollect::cnn
