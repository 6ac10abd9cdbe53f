#pragma once
#include <span>
#include <string>
#include <vector>

#include "anthesis/exchange/parastichies.h"
#include "arguments.h"
#include "outputs.h"

namespace anthesis::cli {

/// The flags that say what becomes of the parastichies.
struct ParastichyArguments {
  std::vector<std::string> outputs;
  std::string organs;
  std::string view = "polar";

  void add_to(CLI::App& app);
  void check() const;  ///< before any work is done

  /// Finds the parastichies and writes them where the flags say. `in_words`: prints them as well.
  void analyse(std::span<const PatternOrgan> pattern, const ParastichyOptions& options, const ParastichyFile& file,
               bool in_words, Report& report) const;
};

}  // namespace anthesis::cli
