#pragma once
#include <string>
#include <vector>

#include "arguments.h"

namespace anthesis::cli {

/// The flags of a study: models of phyllotaxis compared.
struct StudyArguments {
  std::string of;
  std::string sizes = "0.05:0.5:46";

  void add_to(CLI::App& app);
  bool wanted() const { return !of.empty(); }
};

void run_study(const StudyArguments& arguments, const std::vector<std::string>& outputs, int threads, bool json,
               Console& console);

}  // namespace anthesis::cli
