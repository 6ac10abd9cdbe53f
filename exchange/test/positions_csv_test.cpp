#include "anthesis/exchange/positions_csv.h"

#include <gtest/gtest.h>

namespace anthesis {
namespace {

std::string error_of(std::string_view text) {
  const auto read = read_positions(text, "head.csv");
  return read ? "none" : to_string(read.error());
}

TEST(ReadPositions, FindsItsColumnsByName) {
  const std::vector<Vec3> places = {{1.0, 2.0, 3.0}, {-0.5, 1e-3, 4.0}};
  EXPECT_EQ(*read_positions("# a head\nid,z_mm,kind,x_mm,y_mm\n1,3,ray,1,2\n2,4,disk,-0.5,1e-3\n", "a"), places);
  EXPECT_EQ(*read_positions("x;y;z\r\n1;2;3\r\n-0.5; 1e-3 ;4\r\n", "a"), places);
  EXPECT_EQ(*read_positions("  x  y  z\n  1  2  3\n\n-0.5 1e-3 4", "a"), places);
  EXPECT_EQ(*read_positions("\"x\"\t\"y\"\t\"z\"\n1\t2\t3\n-0.5\t0.001\t4\n", "a"), places);
}

TEST(ReadPositions, SaysWhatIsWrongAndWhere) {
  EXPECT_EQ(error_of(""), "head.csv:1:1: must name the columns x, y and z, got nothing");
  EXPECT_EQ(error_of("# only\na,b\n"), "head.csv:2:1: must name the columns x, y and z, got a,b");
  EXPECT_EQ(error_of("x,y,z\n1,2,3\n1,two,3\n"), "head.csv:3:3: must be a finite number for y, got two");
  EXPECT_EQ(error_of("x,y,z\n1,2\n"), "head.csv:2:4: must have a field for z, got 2 fields");
  EXPECT_EQ(error_of("x,y,z\n1,2,nan\n"), "head.csv:2:5: must be a finite number for z, got nan");
  EXPECT_EQ(error_of("x,y,z\n1,2,3.0.0\n"), "head.csv:2:5: must be a finite number for z, got 3.0.0");
}

}  // namespace
}  // namespace anthesis
