#include "anthesis/base/file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstring>

namespace anthesis {
namespace {

Error io_error(const std::string& path, std::string_view doing) {
  return {ErrorCode::kIo, path + ":", "cannot " + std::string(doing) + ": " + std::strerror(errno)};
}

/// Closes the descriptor on every way out.
struct Descriptor {
  int value = -1;
  explicit Descriptor(int fd) : value(fd) {}
  ~Descriptor() { close_now(); }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int close_now() {
    const int result = value >= 0 ? ::close(value) : 0;
    value = -1;
    return result;
  }
};

bool write_all(int fd, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(fd, bytes.data(), bytes.size());
    if (written < 0) {
      if (errno == EINTR) {
        continue;
      }
      return false;
    }
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return true;
}

std::string folder_of(const std::string& path) {
  const std::size_t slash = path.rfind('/');
  return slash == std::string::npos ? "." : path.substr(0, slash + 1);
}

}  // namespace

Expected<std::string> read_file(const std::string& path, std::size_t limit) {
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (file.value < 0) {
    return unexpected(io_error(path, "open"));
  }
  struct stat status {};
  if (::fstat(file.value, &status) != 0) {
    return unexpected(io_error(path, "read"));
  }
  const Error too_large{ErrorCode::kTooLarge, path + ":",
                        "must be at most " + std::to_string(limit) + " bytes" +
                            (S_ISREG(status.st_mode) ? ", got " + std::to_string(status.st_size) : "")};
  if (S_ISREG(status.st_mode) && static_cast<std::size_t>(status.st_size) > limit) {
    return unexpected(too_large);
  }
  std::string bytes;
  char chunk[1 << 16];
  for (;;) {
    const ssize_t count = ::read(file.value, chunk, sizeof chunk);
    if (count < 0) {
      if (errno == EINTR) {
        continue;
      }
      return unexpected(io_error(path, "read"));
    }
    if (count == 0) {
      return bytes;
    }
    bytes.append(chunk, static_cast<std::size_t>(count));
    if (bytes.size() > limit) {
      return unexpected(too_large);
    }
  }
}

struct FileWriter::State {
  std::string path;
  std::string temporary;  ///< empty where the path is written to directly
  Descriptor file{-1};

  ~State() { discard(); }

  void discard() {
    file.close_now();
    if (!temporary.empty()) {
      ::unlink(temporary.c_str());
      temporary.clear();
    }
  }

  Error failed() {
    const Error error = io_error(path, "write");  // before errno is another call's
    discard();
    return error;
  }
};

FileWriter::FileWriter(std::unique_ptr<State> state) : state_(std::move(state)) {}
FileWriter::FileWriter(FileWriter&&) noexcept = default;
FileWriter& FileWriter::operator=(FileWriter&&) noexcept = default;
FileWriter::~FileWriter() = default;

Expected<FileWriter> FileWriter::create(const std::string& path) {
  auto state = std::make_unique<State>();
  state->path = path;
  struct stat status {};
  const bool exists = ::stat(path.c_str(), &status) == 0;
  if (exists && S_ISDIR(status.st_mode)) {
    errno = EISDIR;
    return unexpected(io_error(path, "write"));
  }
  if (exists && !S_ISREG(status.st_mode)) {
    // Renaming over a device would replace it, and a pipe has a reader who waits for these bytes.
    state->file.value = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
  } else {
    // A program that was killed leaves its temporary file behind, and its number may be ours: in a container every
    // process may be number 1.
    static std::atomic<unsigned> counter = 0;
    const mode_t mode = exists ? (status.st_mode & 0777) : 0666;
    std::string temporary;
    do {
      temporary = path + "." + std::to_string(::getpid()) + "-" + std::to_string(counter++) + ".part";
      state->file.value = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode);
    } while (state->file.value < 0 && errno == EEXIST);
    if (state->file.value >= 0) {
      state->temporary = std::move(temporary);
    }
  }
  if (state->file.value < 0) {
    return unexpected(io_error(path, "write"));
  }
  return FileWriter(std::move(state));
}

std::optional<Error> FileWriter::write(std::string_view bytes) {
  if (!write_all(state_->file.value, bytes)) {
    return state_->failed();
  }
  return std::nullopt;
}

std::optional<Error> FileWriter::finish() {
  State& state = *state_;
  const bool is_direct = state.temporary.empty();
  if ((!is_direct && ::fsync(state.file.value) != 0) || state.file.close_now() != 0 ||
      (!is_direct && ::rename(state.temporary.c_str(), state.path.c_str()) != 0)) {
    return state.failed();
  }
  state.temporary.clear();
  if (!is_direct) {
    // The name must survive a power cut too. Some file systems refuse fsync on folders; the file itself is safe by now.
    const Descriptor folder(::open(folder_of(state.path).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    if (folder.value >= 0) {
      ::fsync(folder.value);
    }
  }
  return std::nullopt;
}

std::optional<Error> write_file(const std::string& path, std::string_view bytes) {
  Expected<FileWriter> file = FileWriter::create(path);
  if (!file) {
    return std::move(file.error());
  }
  if (std::optional<Error> error = file->write(bytes)) {
    return error;
  }
  return file->finish();
}

}  // namespace anthesis
