#include "outputs.h"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "anthesis/base/file.h"

namespace anthesis::cli {
namespace {

std::size_t extension_start(const std::string& path) {
  const std::size_t slash = path.rfind('/');
  const std::size_t name = slash == std::string::npos ? 0 : slash + 1;
  const std::size_t dot = path.rfind('.');
  return dot == std::string::npos || dot <= name ? path.size() : dot;
}

std::string extension_of(const std::string& path) {
  const std::size_t start = extension_start(path);
  std::string extension = start < path.size() ? path.substr(start + 1) : "";
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return extension;
}

bool is_device(const std::string& path) {
  struct stat status {};
  return ::stat(path.c_str(), &status) == 0 && !S_ISREG(status.st_mode) && !S_ISDIR(status.st_mode);
}

std::string list_of(std::span<const std::string_view> formats) {
  std::string text;
  for (std::size_t i = 0; i < formats.size(); ++i) {
    text += (i == 0 ? "." : i + 1 == formats.size() ? " or ." : ", .") + std::string(formats[i]);
  }
  return text;
}

}  // namespace

void add_outputs(CLI::App& app, std::vector<std::string>& paths, std::span<const std::string_view> formats) {
  app.add_option("-o,--output", paths, "File to write: " + list_of(formats) + "; may be given more than once")
      ->type_name("FILE")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
}

std::vector<Output> check_outputs(const std::vector<std::string>& paths, std::span<const std::string_view> formats,
                                  const std::string& flag) {
  std::vector<Output> outputs;
  for (const std::string& path : paths) {
    std::string format = extension_of(path);
    if (std::find(formats.begin(), formats.end(), format) == formats.end()) {
      if (!is_device(path)) {
        throw usage(flag + " must end in " + list_of(formats) + ", got " + path);
      }
      format = formats.front();
    }
    if (std::any_of(outputs.begin(), outputs.end(), [&](const Output& other) { return other.path == path; })) {
      throw usage(flag + " names " + path + " twice");
    }
    check_writable(path);
    outputs.push_back({path, std::move(format)});
  }
  return outputs;
}

void check_writable(const std::string& path) {
  const auto refuse = [&](int reason) {
    throw failure({ErrorCode::kIo, path + ":", std::string("cannot write: ") + std::strerror(reason)});
  };
  struct stat status {};
  if (::stat(path.c_str(), &status) == 0) {
    if (S_ISDIR(status.st_mode)) {
      refuse(EISDIR);
    }
    if (::access(path.c_str(), W_OK) != 0) {
      refuse(errno);
    }
    if (!S_ISREG(status.st_mode)) {
      return;
    }
  } else if (errno != ENOENT) {
    refuse(errno);
  }
  // Files are made beside their final place and renamed: it is the folder that must allow writing.
  const std::size_t slash = path.rfind('/');
  const std::string folder = slash == std::string::npos ? "." : path.substr(0, slash + 1);
  if (::stat(folder.c_str(), &status) != 0) {
    refuse(errno);
  }
  if (!S_ISDIR(status.st_mode)) {
    refuse(ENOTDIR);
  }
  if (::access(folder.c_str(), W_OK | X_OK) != 0) {
    refuse(errno);
  }
}

void write_output(Report& report, const std::string& path, std::string_view bytes) {
  const std::optional<Error> error = report.time("write", [&] { return write_file(path, bytes); });
  if (error) {
    throw failure(*error);
  }
  report.add_output(path, bytes);
}

std::string without_extension(const std::string& path) {
  return path.substr(0, extension_start(path));
}

}  // namespace anthesis::cli
