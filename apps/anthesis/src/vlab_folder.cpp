#include "vlab_folder.h"

#include <algorithm>
#include <filesystem>

#include "anthesis/base/file.h"
#include "arguments.h"

namespace anthesis::cli {
namespace {

constexpr std::size_t kMostFiles = 1000;

}  // namespace

std::vector<VlabFile> vlab_files_of(const std::string& folder) {
  std::error_code failed;
  std::vector<std::filesystem::path> paths;
  for (std::filesystem::directory_iterator entry(folder, failed), end; !failed && entry != end;
       entry.increment(failed)) {
    if (is_vlab_head_file(entry->path().filename().string())) {
      paths.push_back(entry->path());
    }
    if (paths.size() > kMostFiles) {
      throw failure({ErrorCode::kTooLarge, folder, "must hold at most 1000 files of VLab, got more"});
    }
  }
  if (failed) {
    throw failure({ErrorCode::kIo, folder, "cannot be read: " + failed.message()});
  }
  std::sort(paths.begin(), paths.end());
  std::vector<VlabFile> files;
  for (const std::filesystem::path& path : paths) {
    files.push_back({path.filename().string(), value_of(read_file(path.string(), kVlabTextLimit))});
  }
  return files;
}

}  // namespace anthesis::cli
