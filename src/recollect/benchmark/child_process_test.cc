#include "recollect/benchmark/child_process.h"

#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>

#include "recollect/core/error.h"

namespace recollect {
namespace {

std::string ErrorOf(const std::function<std::vector<double>()>& body) {
  try {
    RunInChild("leg", body);
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(RunInChild, HandsBackNumbersAndNothingElse) {
  int here = 1;
  const std::vector<double> values = RunInChild("leg", [&] {
    here = 2;
    return std::vector<double>{1.5, -3};
  });
  EXPECT_EQ(values, (std::vector<double>{1.5, -3}));
  EXPECT_EQ(here, 1);
}

TEST(RunInChild, SaysWhatWentWrong) {
  EXPECT_NE(
      ErrorOf([]() -> std::vector<double> { throw Error("here", "no luck"); }).find("no luck"),
      std::string::npos);
  EXPECT_NE(ErrorOf([] {
              std::raise(SIGKILL);
              return std::vector<double>{};
            }).find("leg: its process was lost"),
            std::string::npos);
}

}  // namespace
}  // namespace recollect
