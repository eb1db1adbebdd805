// The whole line, from folders of images to errors beside their baselines, on a drive along the
// test street: it must recollect the right places, and the trained network must beat the key
// frames' own poses by far.
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "recollect/cnn/trainer.h"
#include "recollect/core/error.h"
#include "recollect/core/files.h"
#include "recollect/core/parallel.h"
#include "recollect/evaluation/report.h"
#include "recollect/testing/scratch_folder.h"
#include "recollect/testing/street.h"

namespace recollect {
namespace {

namespace fs = std::filesystem;

const Row& Find(const std::vector<Row>& rows, const std::string& name) {
  for (const Row& row : rows) {
    if (row.name == name) return row;
  }
  throw Error(name, "no such row");
}

TEST(Pipeline, LocalisesALapThatWasNotMapped) {
  const testing::ScratchFolder folder;
  using testing::DriveStreet;
  const std::vector<Lap> mapped = {
      DriveStreet(folder / "lap-01", {.lateral_m = 0.6, .seed = 1}),
      DriveStreet(folder / "lap-02", {.lateral_m = -0.5, .brightness = 0.8, .seed = 2})};
  const Lap live = DriveStreet(folder / "lap-03", {.lateral_m = 0.1, .brightness = 0.6, .seed = 3});

  ThreadPool pool;
  CreateMap(folder / "street.map", mapped, {}, pool);
  cnn::TrainOptions train = cnn::TrainOptions::Compact();
  train.epochs = 1;
  train.out = folder / "street.model";
  const cnn::TrainResult trained = cnn::Train(mapped, {}, train);
  EXPECT_LT(trained.model.validation.position_mean_m,
            0.5 * trained.model.validation.no_motion_mean_m);

  const Map map = Map::Open(folder / "street.map");
  Localizer localizer(map, cnn::PoseNetwork::Load(train.out), pool);
  const Evaluation evaluation = Evaluate(localizer, live);
  SCOPED_TRACE(FormatTable(evaluation));
  ASSERT_EQ(evaluation.frames.size(), live.frames.size());
  // A straight street of like houses is hard for the committee: it measured 0.68 and 0.77 when
  // these bounds were set. Guessing gives about 1 in 12 places and 1 in 5 of the frames.
  EXPECT_GE(evaluation.within_labels.at(0), 0.5);
  EXPECT_GE(evaluation.within_frames.at(5), 0.6);
  const double retrieval = Find(evaluation.rows_good_retrieval, "retrieval").position_m.mean;
  const double oracle = Find(evaluation.rows, "oracle").position_m.mean;
  EXPECT_LT(Find(evaluation.rows_good_retrieval, "system").position_m.mean, 0.4 * retrieval);
  EXPECT_LT(Find(evaluation.rows, "oracle_cnn").position_m.mean, 0.5 * oracle);
  EXPECT_LT(Find(evaluation.rows, "system").heading_deg.median, 1.5);

  WriteReport(evaluation, map, folder / "report");
  const auto figures = nlohmann::json::parse(ReadFile(folder / "report" / "figures.json"));
  EXPECT_DOUBLE_EQ(figures["position_m"]["retrieval"]["mean"].get<double>(),
                   Find(evaluation.rows, "retrieval").position_m.mean);
  EXPECT_GT(fs::file_size(folder / "report" / "evaluation.png"), 10000u);
}

}  // namespace
}  // namespace recollect
