#pragma once
#include <cstdint>
#include <vector>

#include "anthesis/contact/sheet.h"

namespace anthesis {

/// A patch of columns x rows vertices, row after row; or a tube, if it closes round.
inline Sheet grid_sheet(std::uint32_t columns, std::uint32_t rows, bool closed = false) {
  std::vector<Triangle> triangles;
  for (std::uint32_t r = 0; r + 1 < rows; ++r) {
    for (std::uint32_t c = 0; c + (closed ? 0 : 1) < columns; ++c) {
      const std::uint32_t a = r * columns + c;
      const std::uint32_t b = r * columns + (c + 1) % columns;
      triangles.push_back({a, b, b + columns});
      triangles.push_back({a, b + columns, a + columns});
    }
  }
  return make_sheet(columns * rows, triangles);
}

}  // namespace anthesis
