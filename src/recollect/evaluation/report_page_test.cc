// Reports in Debian's chromium (web/test/browser.mjs): no errors, charts with data, images where
// one points.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <opencv2/imgproc.hpp>

#include "recollect/core/error.h"
#include "recollect/core/files.h"
#include "recollect/core/parallel.h"
#include "recollect/core/random.h"
#include "recollect/evaluation/html_report.h"
#include "recollect/evaluation/paper.h"
#include "recollect/evaluation/thumbnails.h"
#include "recollect/testing/scratch_folder.h"
#include "recollect/testing/street.h"

namespace recollect {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

class ReportPageTest : public ::testing::Test {
 protected:
  void SetUp() override {
    for (const char* needed : {RECOLLECT_PAGE_TEMPLATE, "/usr/bin/chromium",
                               RECOLLECT_WEB_FOLDER "/node_modules/playwright-core"}) {
      if (!fs::exists(needed)) {
        GTEST_SKIP() << needed << " is missing (apt-get install nodejs npm chromium; make build)";
      }
    }
    for (int lap = 1; lap <= 3; ++lap) {
      laps_.push_back(testing::DriveStreet(
          folder_ / "laps" / fmt::format("lap-0{}", lap),
          {.length_m = 24, .lateral_m = 0.2 * lap, .seed = static_cast<std::uint64_t>(lap)}));
    }
    cnn::PoseNetwork::Untrained(320, 240).Save(folder_ / "untrained.model");
    AtomicWrite(folder_ / "curve.csv",
                "step,loss,valid_position_m,train_position_m\n10,3,2.5,2.4\n20,2,2.1,1.9\n");
  }

  PaperOptions Options() const {
    PaperOptions options;
    options.data = folder_ / "laps";
    options.out = folder_ / "out";
    options.page_template = RECOLLECT_PAGE_TEMPLATE;
    options.images = "rendered";
    options.model = folder_ / "untrained.model";
    options.curve = folder_ / "curve.csv";
    options.statistics.segment_m = 4;
    options.evaluation.every = 3;
    options.stamp.command = "recollect experiment paper --data 'a </script> b'";
    options.threads = 2;
    return options;
  }

  static void ExpectRight(const fs::path& page) {
    const std::string command = fmt::format("cd '{}' && node test/browser.mjs '{}' 2>&1",
                                            RECOLLECT_WEB_FOLDER, page.string());
    EXPECT_EQ(std::system(command.c_str()), 0);
  }

  testing::ScratchFolder folder_;
  std::vector<Lap> laps_;
};

TEST_F(ReportPageTest, OfAStreetIsWhole) {
  const json run = RunPaper(laps_, Options());
  EXPECT_EQ(run["frames"]["frame"].size(), 8u);
  for (const char* file :
       {"table.txt", "laps.csv", "accuracy.csv", "errors.csv", "paired.csv", "training.csv",
        "accuracy.svg", "training.svg", "errors.svg", "along.svg", "plan.svg", "estimate.tum",
        "estimate.kitti", "truth.tum", "truth.kitti", "frames.csv", "run.json"}) {
    EXPECT_TRUE(fs::exists(folder_ / "out" / file)) << file;
  }
  ExpectRight(folder_ / "out" / "report.html");

  // What is done is not done again; what the page lacks is.
  const auto made = fs::last_write_time(folder_ / "out" / "recollect.map");
  const std::string before = ReadFile(folder_ / "out" / "localise.json");
  fs::remove(folder_ / "out" / "report.html");
  PaperOptions again = Options();
  again.stamp.command = "typed otherwise";
  EXPECT_EQ(RunPaper(laps_, again)["rows"], run["rows"]);
  EXPECT_EQ(fs::last_write_time(folder_ / "out" / "recollect.map"), made);
  EXPECT_EQ(ReadFile(folder_ / "out" / "localise.json"), before);
  EXPECT_TRUE(fs::exists(folder_ / "out" / "report.html"));
}

// As many images as the paper's test lap has, and more key frames than its map shows, none of them
// easy to compress.
TEST_F(ReportPageTest, OfThePapersSizeIsBelow25Megabytes) {
  constexpr int kLive = 2832, kKeys = 3200;
  PaperOptions options = Options();
  options.network = false;
  options.model.clear();
  json run = RunPaper(laps_, options);
  const Map map = Map::Open(folder_ / "out" / "recollect.map");
  Evaluation e;
  Random random(1);
  for (const char* name : {"gps", "oracle_cnn", "system", "pnp_oracle", "pnp", "fused", "localised",
                           "retrieval", "oracle"}) {
    e.rows.emplace_back().name = name;
  }
  for (int i = 0; i < kLive; ++i) {
    LiveFrame& f = e.frames.emplace_back();
    f.frame = static_cast<std::size_t>(i);
    const double turn = i * 6.283 / kLive;
    f.true_world_from_camera =
        SE3(Eigen::Matrix3d::Identity(), {600 * std::cos(turn), 450 * std::sin(turn), 0});
    f.answer.world_from_camera =
        f.true_world_from_camera * SE3(Eigen::Matrix3d::Identity(), {0.3 * random.Normal(), 0, 0});
    f.answer.key_frame = i % kKeys;
    f.nearest_key_frame = (i + 400) % kKeys;
    f.answer.votes = {{i, 1200}, {i + 1, 400}, {i + 2, 90}, {i + 3, 70}, {i + 4, 60}};
    for (Row& row : e.rows) {
      row.frames.push_back(f.frame);
      row.errors.push_back({std::abs(random.Normal()), 0.5});
    }
  }
  e.rows_good_retrieval = {e.rows.back()};
  e.latency_ms = {{"total", {80, 120}}};
  run.update(EvaluationJson(e, map, {}, {.bootstrap = {.resamples = 20}}));
  for (int key = map.size(); key < kKeys; ++key) {
    run["keys"]["at"].push_back(
        {600 * std::cos(key * 6.283 / kKeys), 452 * std::sin(key * 6.283 / kKeys)});
    run["keys"]["lap"].push_back("lap-01");
    run["keys"]["frame"].push_back(key);
  }

  const std::size_t each = BytesAnImage(kLive + kKeys, kImageBudget);
  json images;
  cv::Mat image(480, 640, CV_8UC3);
  cv::RNG noise(1);
  for (int i = 0; i < kLive + kKeys; ++i) {
    if (i % 50 == 0) {  // noise as fine as the thumbnail's pixels
      cv::Mat coarse(120, 160, CV_8UC3);
      noise.fill(coarse, cv::RNG::NORMAL, 120, 50);
      cv::resize(coarse, image, image.size(), 0, 0, cv::INTER_LINEAR);
    }
    const std::string jpeg = i % 50 == 0 || images.empty()
                                 ? Thumbnail(image, each)
                                 : images["live"].back().get<std::string>();
    if (i < kLive) {
      images["live"].push_back(jpeg);
    } else {
      images["keys"][std::to_string(i - kLive)] = jpeg;
    }
  }
  const fs::path page = folder_ / "large.html";
  WriteHtmlReport(run, images, RECOLLECT_PAGE_TEMPLATE, page);
  EXPECT_LT(fs::file_size(page), 25'000'000u);
  EXPECT_GT(fs::file_size(page), 10'000'000u);  // there is something to open
  ExpectRight(page);
}

}  // namespace
}  // namespace recollect
