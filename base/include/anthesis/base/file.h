#pragma once
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "anthesis/base/error.h"

namespace anthesis {

/// The bytes of a file. More than `limit` bytes is kTooLarge, found out without reading them; anything else that fails
/// is kIo with the system's reason.
Expected<std::string> read_file(const std::string& path, std::size_t limit);

/// A file that is written piece by piece and appears whole or not at all: temporary file in the same folder, fsync,
/// rename. Without `finish` nothing appears and nothing is left.
///
/// A path that exists and is no regular file (a device, a pipe) is written to directly.
class FileWriter {
 public:
  /// Failure is kIo with the system's reason.
  static Expected<FileWriter> create(const std::string& path);

  FileWriter(FileWriter&&) noexcept;
  FileWriter& operator=(FileWriter&&) noexcept;
  ~FileWriter();

  /// Appends. Failure is kIo and leaves nothing; only destruction may follow.
  std::optional<Error> write(std::string_view bytes);

  /// The file is there, and safe, when this returns no error. Nothing may follow.
  std::optional<Error> finish();

 private:
  struct State;
  explicit FileWriter(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// Writes a whole file as FileWriter does. Failure is kIo and leaves nothing.
std::optional<Error> write_file(const std::string& path, std::string_view bytes);

}  // namespace anthesis
