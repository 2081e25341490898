// SPDX-License-Identifier: MIT
/// \file
/// Short ways to write shapes in tests.
#pragma once

#include "fabseq/part/shape.h"

#include <utility>
#include <vector>

namespace fabseq::test {

inline Shape box(std::vector<double> min, std::vector<double> max) {
  Shape shape;
  shape.kind = Shape::Kind::box;
  shape.first = std::move(min);
  shape.second = std::move(max);
  return shape;
}

inline Shape combine(Shape::Kind kind, std::vector<Shape> operands) {
  Shape shape;
  shape.kind = kind;
  shape.operands = std::move(operands);
  return shape;
}

inline Shape union_of(std::vector<Shape> operands) {
  return combine(Shape::Kind::union_of, std::move(operands));
}

}  // namespace fabseq::test
