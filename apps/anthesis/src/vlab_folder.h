#pragma once
#include <optional>
#include <string>
#include <vector>

#include "anthesis/exchange/vlab_species.h"

namespace anthesis::cli {

/// The files of a folder that are about a flower head, in the order of their names. Throws a Failure.
std::vector<VlabFile> vlab_files_of(const std::string& folder);

/// A species' name out of a folder's: letters, digits, - and _.
std::string name_of_folder(const std::string& folder);

/// The head of O24 that a word names, and the one whose name a folder's contains. The first throws a Failure of usage.
HeadModel head_model(const std::string& name);
std::optional<HeadModel> head_model_in(const std::string& folder);

}  // namespace anthesis::cli
