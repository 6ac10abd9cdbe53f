#pragma once

namespace anthesis {

/// The release this library is; written into every output. Equal to the project version in CMakeLists.txt (tested).
inline constexpr char kVersion[] = "0.1.0";

}  // namespace anthesis
