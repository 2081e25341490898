// SPDX-License-Identifier: MIT
/// \file
/// Text of SVG pictures.
#pragma once

#include <string>

namespace fabseq::svg {

/// The beginning of a white picture of that size in pixels; "</svg>" ends it.
std::string begin(double width, double height);
/// Text as XML takes it.
std::string escaped(const std::string& text);
/// A coordinate to a hundredth of a pixel.
std::string number(double value);

}  // namespace fabseq::svg
