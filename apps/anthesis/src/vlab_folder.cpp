#include "vlab_folder.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>

#include "anthesis/base/file.h"
#include "arguments.h"

namespace anthesis::cli {
namespace {

constexpr std::size_t kMostFiles = 1000;
constexpr std::array kModels = {VlabHeadModel::kBellis, VlabHeadModel::kSunflower, VlabHeadModel::kGerbera};

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

VlabHeadModel head_model(const std::string& name) {
  for (const VlabHeadModel model : kModels) {
    if (vlab_head_model_name(model) == name) {
      return model;
    }
  }
  throw usage("--like must be bellis, sunflower or gerbera, got " + name);
}

std::optional<VlabHeadModel> head_model_in(const std::string& folder) {
  const std::string name = name_of_folder(folder);
  for (const VlabHeadModel model : kModels) {
    if (name.find(vlab_head_model_name(model)) != std::string::npos) {
      return model;
    }
  }
  return std::nullopt;
}

}  // namespace anthesis::cli
