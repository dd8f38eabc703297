// SPDX-License-Identifier: MIT
#pragma once
// The fixed parts of a header with a table's filters, with @fields@ to fill in. Its arithmetic is that of
// export/run/switching_run.cpp, operation by operation.

#include <string>
#include <string_view>

#include "ripplenotch/export/filter_set.hpp"

namespace ripplenotch {

/// Declarations that identify the form of a header to a reader.
inline constexpr std::string_view svf_fields = "a1, a2, a3, m0, m1, m2;";
inline constexpr std::string_view df1_memory = "x1, x2, y1, y2;";

class SwitchingCode {
  public:
    SwitchingCode(const Arithmetic& arithmetic, const FilterSet& filters);

    [[nodiscard]] std::string declarations() const;
    [[nodiscard]] std::string regions_open() const;
    [[nodiscard]] std::string section_functions() const;
    [[nodiscard]] std::string step_function() const;
    [[nodiscard]] std::string self_test_open() const;
    [[nodiscard]] std::string self_test_function() const;

  private:
    [[nodiscard]] std::string product(std::string_view coefficient, std::string_view signal) const;
    [[nodiscard]] std::string supervisor() const;
    [[nodiscard]] std::string blend_functions() const;
    [[nodiscard]] std::string filter_code() const;

    Arithmetic arithmetic_;
    bool fixed_, by_speed_, all_bands_, blends_;
};

}  // namespace ripplenotch
