#pragma once
#include <vector>

#include "anthesis/receptacle/growing_receptacle.h"

namespace anthesis::test {

/// A head of three sections: a flat dome, a taller one, a bulging one. The first has one landmark, the last three.
inline DigitisedHead tiny_head() {
  DigitisedHead head;
  head.sections.resize(3);
  head.sections[0].profile = {3, {{0.0, 0.5}, {0.5, 0.5}, {1.0, 0.25}, {1.0, 0.0}}};
  head.sections[1].profile = {3, {{0.0, 1.5}, {0.8, 1.5}, {1.8, 1.2}, {2.0, 0.5}, {1.5, 0.0}}};
  head.sections[2].profile = {3, {{0.0, 3.0}, {1.0, 3.0}, {3.5, 2.5}, {4.0, 1.0}, {3.0, 0.5}, {2.0, 0.0}}};
  head.sections[0].landmarks = {0.8};
  head.sections[1].landmarks = {0.75, 0.5};
  head.sections[2].landmarks = {0.8, 0.4, 0.1};
  head.sections[0].ring = 0.8;
  head.sections[1].ring = 0.4;
  head.sections[2].ring = 0.0;
  return head;
}

}  // namespace anthesis::test
