#pragma once
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "arguments.h"

namespace anthesis::cli {

/// A file to write.
struct Output {
  std::string path;
  std::string format;  ///< "glb": the extension in small letters
};

/// The -o flag.
void add_outputs(CLI::App& app, std::vector<std::string>& paths, std::span<const std::string_view> formats);

/// The outputs that `paths` name. Refuses, before any work is done, formats that are not among `formats`, a path given
/// twice, and places that cannot be written to. A device or a pipe takes the first format, whatever its name.
std::vector<Output> check_outputs(const std::vector<std::string>& paths, std::span<const std::string_view> formats,
                                  const std::string& flag = "-o");

/// The same for one path of a known format.
void check_writable(const std::string& path);

/// Writes a file, whole or not at all, and reports it.
void write_output(Report& report, const std::string& path, std::string_view bytes);

/// "out/flower.glb" -> "out/flower"
std::string without_extension(const std::string& path);

}  // namespace anthesis::cli
