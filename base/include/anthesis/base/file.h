#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "anthesis/base/error.h"

namespace anthesis {

/// The bytes of a file. More than `limit` bytes is kTooLarge, found out without reading them; anything else that fails
/// is kIo with the system's reason.
Expected<std::string> read_file(const std::string& path, std::size_t limit);

/// Writes a file that appears whole or not at all: temporary file in the same folder, fsync, rename.
/// A path that exists and is no regular file (a device, a pipe) is written to directly. Failure is kIo and leaves
/// nothing.
std::optional<Error> write_file(const std::string& path, std::string_view bytes);

}  // namespace anthesis
