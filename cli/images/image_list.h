// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_IMAGES_IMAGE_LIST_H_
#define RSSTAB_CLI_IMAGES_IMAGE_LIST_H_

#include <string>
#include <vector>

#include "igf/base/result.h"

namespace rsstab::images {

// The pictures that a user named.
struct ImageList {
  std::vector<std::string> paths;  // in the order of the arguments, each once
  std::vector<Error> problems;     // arguments that name none
  // More than one picture was or could have been meant: several arguments, a folder or a pattern.
  bool is_plural = false;
};

// A folder stands for the pictures in it, by name and without those in its folders or hidden ones;
// a pattern with *, ? or [..] for the files that match it (the shell need not expand it); anything
// else for the file of that name, be it there or not.
[[nodiscard]] ImageList ListImages(const std::vector<std::string>& arguments);

}  // namespace rsstab::images

#endif  // RSSTAB_CLI_IMAGES_IMAGE_LIST_H_
