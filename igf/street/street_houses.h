// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_IGF_STREET_STREET_HOUSES_H_
#define RSSTAB_IGF_STREET_STREET_HOUSES_H_

#include "igf/street/street_canvas.h"

namespace rsstab::igf {

// A row of houses from one end of the street to the other, shops and lanes between them; no two
// windows alike.
void PaintHouses(StreetCanvas& canvas);

}  // namespace rsstab::igf

#endif  // RSSTAB_IGF_STREET_STREET_HOUSES_H_
