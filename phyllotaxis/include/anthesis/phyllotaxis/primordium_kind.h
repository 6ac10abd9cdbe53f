#pragma once
#include <cstdint>

namespace anthesis {

/// What becomes of a primordium of a flower head, by where it stands among the landmarks of the tissue.
enum class PrimordiumKind : std::uint8_t {
  kBract,        ///< outside the bract landmark
  kTransFloret,  ///< between the two landmarks; heads without trans florets have none
  kFloret,       ///< inside both: of the disc; in Bellis and sunflower all florets
};

}  // namespace anthesis
