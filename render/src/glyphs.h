#pragma once
#include <array>

namespace anthesis {

/// A letter of 5 by 7 points.
struct Glyph {
  static constexpr int kColumns = 5;
  static constexpr int kRows = 7;
  static constexpr int kAdvance = kColumns + 1;  ///< from a letter to the next

  char character;
  std::array<unsigned char, kRows> rows;  ///< from the top; bits from left to right: 16 8 4 2 1

  constexpr bool lit(int column, int row) const { return (rows[row] >> (kColumns - 1 - column) & 1) != 0; }
};

/// Those of write_caption; a question mark for any other character but the space.
const Glyph& glyph_of(char character);

}  // namespace anthesis
