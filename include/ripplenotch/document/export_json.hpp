// SPDX-License-Identifier: MIT
#pragma once
// What `export` wrote and what came back when it was read again.

#include <cstddef>
#include <string>
#include <vector>

#include "ripplenotch/document/provenance.hpp"
#include "ripplenotch/export/verify.hpp"

namespace ripplenotch {

struct ExportReport {
    std::string target;  ///< as it would be typed again, with its keys
    std::string file;    ///< as given to -o
    std::size_t bytes = 0;
    Hertz sample_rate;
    std::size_t bands = 0, sections_per_band = 0;
    std::vector<std::string> warnings;
    std::string usage;       ///< one line to paste; may be empty
    bool verified = false;   ///< what follows is known
    std::string arithmetic;  ///< "float32, state-variable form"
    std::vector<SectionCheck> checks;
    std::vector<std::string> violations;
};

[[nodiscard]] std::string export_report_to_json(const ExportReport& report, const Provenance& provenance);

}  // namespace ripplenotch
