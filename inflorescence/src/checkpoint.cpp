#include "checkpoint.h"

#include <cstring>
#include <filesystem>
#include <string_view>
#include <type_traits>

#include "anthesis/base/assert.h"
#include "anthesis/base/file.h"
#include "anthesis/base/sha256.h"

namespace anthesis::detail {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kMagic = "anthesis checkpoint 1\n";
constexpr std::size_t kMaxBytes = std::size_t{8} << 30;

constexpr std::string_view kSuffix = ".checkpoint";

std::string state_file(const std::string& folder) {
  return (fs::path(folder) / ("state" + std::string(kSuffix))).string();
}
std::string frame_file(const std::string& folder, std::size_t frame) {
  return (fs::path(folder) / ("frame-" + std::to_string(frame) + std::string(kSuffix))).string();
}

/// Plain values one after the other, and their hash at the end: a file that was cut short or changed is found out.
class Writer {
 public:
  Writer() : bytes_(kMagic) {}
  template <class T>
  void value(const T& v) {
    static_assert(std::is_trivially_copyable_v<T>);
    bytes_.append(reinterpret_cast<const char*>(&v), sizeof(T));
  }
  void text(std::string_view v) {
    value(std::uint64_t{v.size()});
    bytes_.append(v);
  }
  template <class T>
  void list(const std::vector<T>& v) {
    static_assert(std::is_trivially_copyable_v<T>);
    value(std::uint64_t{v.size()});
    bytes_.append(reinterpret_cast<const char*>(v.data()), v.size() * sizeof(T));
  }
  std::string finish() {
    bytes_ += sha256(bytes_);
    return std::move(bytes_);
  }

 private:
  std::string bytes_;
};

class Reader {
 public:
  explicit Reader(std::string_view bytes) {
    constexpr std::size_t kHash = 64;
    if (bytes.size() >= kMagic.size() + kHash && bytes.substr(0, kMagic.size()) == kMagic &&
        sha256(bytes.substr(0, bytes.size() - kHash)) == bytes.substr(bytes.size() - kHash)) {
      rest_ = bytes.substr(kMagic.size(), bytes.size() - kHash - kMagic.size());
      good_ = true;
    }
  }
  bool good() const { return good_; }
  template <class T>
  void value(T& v) {
    if (take(sizeof(T))) {
      std::memcpy(&v, taken_.data(), sizeof(T));
    }
  }
  std::string text() {
    std::uint64_t size = 0;
    value(size);
    return take(size) ? std::string(taken_) : std::string();
  }
  template <class T>
  void list(std::vector<T>& v) {
    std::uint64_t size = 0;
    value(size);
    if (size <= rest_.size() / sizeof(T) && take(size * sizeof(T))) {
      v.resize(size);
      if (size > 0) {
        std::memcpy(static_cast<void*>(v.data()), taken_.data(), taken_.size());
      }
    } else {
      good_ = false;
    }
  }

 private:
  bool take(std::uint64_t size) {
    good_ = good_ && size <= rest_.size();
    if (good_) {
      taken_ = rest_.substr(0, size);
      rest_.remove_prefix(size);
    }
    return good_;
  }

  std::string_view rest_;
  std::string_view taken_;
  bool good_ = false;
};

Error damaged(const std::string& path) {
  return {ErrorCode::kParse, path + ":", "must be a whole checkpoint; it is damaged or not one at all"};
}

}  // namespace

bool has_checkpoint(const std::string& folder) {
  std::error_code ignored;
  return fs::exists(state_file(folder), ignored);
}

std::optional<Error> save_checkpoint(const std::string& folder, const std::string& key, const Checkpoint& checkpoint,
                                     std::size_t frames_saved) {
  std::error_code failed;
  fs::create_directories(folder, failed);
  if (failed) {
    return Error{ErrorCode::kIo, folder + ":", "cannot make the folder: " + failed.message()};
  }
  for (std::size_t i = frames_saved; i < checkpoint.seen_mm.size(); ++i) {
    Writer writer;
    writer.text(key);
    writer.list(checkpoint.seen_mm[i]);
    if (auto error = write_file(frame_file(folder, i), writer.finish())) {
      return error;
    }
  }
  Writer writer;
  writer.text(key);
  writer.value(checkpoint.next_step);
  writer.value(std::uint64_t{checkpoint.seen_mm.size()});
  writer.value(checkpoint.report);
  std::vector<std::uint32_t> sheet;
  std::vector<double> thickness;
  std::vector<std::uint8_t> fixed;
  for (const GrowingBody& body : checkpoint.snapshot.bodies) {
    sheet.push_back(body.sheet);
    thickness.push_back(body.thickness_mm);
    fixed.push_back(body.fixed);
  }
  writer.list(sheet);
  writer.list(thickness);
  writer.list(fixed);
  writer.list(checkpoint.snapshot.positions_mm);
  writer.list(checkpoint.snapshot.targets_mm);
  writer.list(checkpoint.snapshot.awake);
  writer.list(checkpoint.snapshot.bent);
  writer.list(checkpoint.snapshot.wanted_mm);
  return write_file(state_file(folder), writer.finish());
}

Expected<Checkpoint> load_checkpoint(const std::string& folder, const std::string& key) {
  Checkpoint checkpoint;
  if (!has_checkpoint(folder)) {
    return checkpoint;
  }
  const auto other_run = [&](const std::string& path) {
    return Error{
        ErrorCode::kInvalidParameter, path + ":",
        "must be of the same species, seed, detail, times, options and version of the program; it is of another run"};
  };
  const auto bytes = read_file(state_file(folder), kMaxBytes);
  if (!bytes) {
    return unexpected(bytes.error());
  }
  Reader reader(*bytes);
  if (reader.good() && reader.text() != key) {
    return unexpected(other_run(state_file(folder)));
  }
  std::uint64_t frames = 0;
  std::vector<std::uint32_t> sheet;
  std::vector<double> thickness;
  std::vector<std::uint8_t> fixed;
  reader.value(checkpoint.next_step);
  reader.value(frames);
  reader.value(checkpoint.report);
  reader.list(sheet);
  reader.list(thickness);
  reader.list(fixed);
  reader.list(checkpoint.snapshot.positions_mm);
  reader.list(checkpoint.snapshot.targets_mm);
  reader.list(checkpoint.snapshot.awake);
  reader.list(checkpoint.snapshot.bent);
  reader.list(checkpoint.snapshot.wanted_mm);
  if (!reader.good() || thickness.size() != sheet.size() || fixed.size() != sheet.size() || frames > 1'000'000) {
    return unexpected(damaged(state_file(folder)));
  }
  for (std::size_t i = 0; i < sheet.size(); ++i) {
    checkpoint.snapshot.bodies.push_back({sheet[i], thickness[i], fixed[i] != 0});
  }
  for (std::size_t i = 0; i < frames; ++i) {
    const auto frame = read_file(frame_file(folder, i), kMaxBytes);
    if (!frame) {
      return unexpected(frame.error());
    }
    Reader of_frame(*frame);
    if (of_frame.good() && of_frame.text() != key) {
      return unexpected(other_run(frame_file(folder, i)));
    }
    of_frame.list(checkpoint.seen_mm.emplace_back());
    if (!of_frame.good()) {
      return unexpected(damaged(frame_file(folder, i)));
    }
  }
  return checkpoint;
}

void remove_checkpoint(const std::string& folder) {
  ANTHESIS_ASSERT(!folder.empty());
  // The state goes first: what is left of frames without it is nothing to go on from, a state without them is damaged.
  std::error_code failed;
  fs::remove(state_file(folder), failed);
  if (failed) {
    return;
  }
  // Also what a run that was killed while it wrote left behind: names that go on after these.
  std::error_code ignored;
  std::vector<fs::path> ours;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, ignored)) {
    const std::string name = entry.path().filename().string();
    const bool numbered = name.rfind("frame-", 0) == 0 && name.find(kSuffix) != std::string::npos;
    if (numbered || name.rfind("state" + std::string(kSuffix), 0) == 0) {
      ours.push_back(entry.path());
    }
  }
  for (const fs::path& path : ours) {
    fs::remove(path, ignored);
  }
  fs::remove(folder, ignored);  // does nothing to a folder that holds anything else
}

}  // namespace anthesis::detail
