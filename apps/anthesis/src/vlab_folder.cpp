#include "vlab_folder.h"

#include <algorithm>
#include <cctype>
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

std::string name_of_folder(const std::string& folder) {
  std::filesystem::path path = std::filesystem::path(folder).lexically_normal();
  std::string name = (path.has_filename() ? path : path.parent_path()).filename().string().substr(0, 64);
  for (char& c : name) {
    const bool plain = std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '_';
    c = plain ? c : '-';
  }
  return name.empty() || name == "." || name == "-" ? "head" : name;
}

HeadModel head_model(const std::string& name) {
  const std::vector<std::string_view> words(kHeadModelNames.begin(), kHeadModelNames.end());
  return static_cast<HeadModel>(parse_word("--like", name, words));
}

std::optional<HeadModel> head_model_in(const std::string& folder) {
  std::string name = name_of_folder(folder);
  std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::tolower(c); });
  for (std::size_t model = 0; model < kHeadModelNames.size(); ++model) {
    if (name.find(kHeadModelNames[model]) != std::string::npos) {
      return static_cast<HeadModel>(model);
    }
  }
  return std::nullopt;
}

}  // namespace anthesis::cli
