// SPDX-License-Identifier: MIT
#pragma once
// The bar on standard error for work that takes longer than a second; only on a terminal, and gone
// afterwards.

#include <memory>
#include <string>
#include <vector>

namespace ripplenotch {

class ProgressBar {
  public:
    /// Shows nothing when standard error is no terminal, is one that cannot erase (TERM=dumb), or `words` of
    /// the command line hold -q or --quiet. One at a time.
    explicit ProgressBar(const std::vector<std::string>& words);
    ~ProgressBar();
    ProgressBar(const ProgressBar&) = delete;
    ProgressBar& operator=(const ProgressBar&) = delete;

  private:
    struct Painter;
    std::unique_ptr<Painter> painter_;
};

}  // namespace ripplenotch
