#pragma once
#include <string_view>

#include "anthesis/render/picture.h"

namespace anthesis {

/// Writes lines of text, parted by \n, along the lower edge of an image: light with a dark rim, centred, in letters of
/// 5 by 7 points as large as fits, at most 200 points to the image's height. ASCII letters, digits and _=-+.,:[]()/
/// are known; a question mark stands for any other. A line too long for the image loses its beginning.
void write_caption(Image& image, std::string_view text);

}  // namespace anthesis
