#include "anthesis/base/error.h"

#include <gtest/gtest.h>

#include <array>
#include <clocale>

namespace anthesis {
namespace {

TEST(InvalidParameter, NamesTheRuleAndTheValue) {
  const Error error = invalid_parameter("head.interval", "must be > 0", -0.4);
  EXPECT_EQ(error.code, ErrorCode::kInvalidParameter);
  EXPECT_EQ(to_string(error), "head.interval must be > 0, got -0.4");
}

TEST(ToText, ReadsBackAsTheSameNumberAndIgnoresTheLocale) {
  std::setlocale(LC_ALL, "de_DE.UTF-8");
  for (const double value : {0.1, 137.50776405003785, -1e-300, 1e22, 5.0}) {
    const std::string text = to_text(value);
    EXPECT_EQ(text.find(','), std::string::npos);
    std::setlocale(LC_ALL, "C");
    EXPECT_EQ(std::stod(text), value) << text;
  }
}

TEST(NearestName, FindsSlipsOfTheKeyboardAndNothingElse) {
  const std::array<std::string_view, 3> names = {"divergence_deg", "interval", "zones"};
  EXPECT_EQ(nearest_name("divergance_deg", names.data(), names.size()), "divergence_deg");
  EXPECT_EQ(nearest_name("intevral", names.data(), names.size()), "interval");
  EXPECT_EQ(nearest_name("zone", names.data(), names.size()), "zones");
  EXPECT_EQ(nearest_name("petiole", names.data(), names.size()), "");
  EXPECT_EQ(nearest_name(std::string(100000, 'x'), names.data(), names.size()), "");
}

TEST(ExitCode, TellsBadDataFromFailedFiles) {
  EXPECT_EQ(exit_code(ErrorCode::kParse), 65);
  EXPECT_EQ(exit_code(ErrorCode::kIo), 74);
}

}  // namespace
}  // namespace anthesis
