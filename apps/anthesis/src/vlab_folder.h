#pragma once
#include <string>
#include <vector>

#include "anthesis/exchange/vlab_species.h"

namespace anthesis::cli {

/// The files of a folder that are about a flower head, in the order of their names. Throws a Failure.
std::vector<VlabFile> vlab_files_of(const std::string& folder);

}  // namespace anthesis::cli
