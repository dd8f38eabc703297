// SPDX-License-Identifier: MIT
// Sample by sample against vectors that SciPy made and Octave confirmed: scripts/make-filter-reference.
#include <fstream>
#include <sstream>

#include "filter/tables.hpp"
#include "ripplenotch/core/number.hpp"
#include "support/catch.hpp"
#include "support/places.hpp"

using namespace ripplenotch;
using namespace ripplenotch::testing;

namespace {

struct Reference {
    std::vector<double> velocity_deg_s, torque_nm, expected_nm;
};

Reference read(const std::string& name) {
    std::ifstream file(source_folder() + "/tests/filter/data/" + name + ".csv");
    Reference reference;
    std::string line;
    std::getline(file, line);
    REQUIRE(line == "velocity_deg_s,torque_nm,expected_nm");
    while (std::getline(file, line)) {
        std::istringstream cells(line);
        std::string cell;
        for (auto* column : {&reference.velocity_deg_s, &reference.torque_nm, &reference.expected_nm}) {
            std::getline(cells, cell, ',');
            const auto value = parse_number(cell);
            REQUIRE(value);
            column->push_back(*value);
        }
    }
    REQUIRE(reference.torque_nm.size() == 600);
    return reference;
}

void check(const std::string& name, const std::string& spec) {
    const Reference reference = read(name);
    const CandidateTable table = paper_table();
    const auto out = filtered(*start(spec, &table), {reference.velocity_deg_s, reference.torque_nm, {}});
    double worst = 0.0;
    for (std::size_t k = 0; k < out.size(); ++k)
        worst = std::max(worst, std::abs(out[k] - reference.expected_nm[k]));
    INFO(name);
    CHECK(worst < 1e-9);
}

}  // namespace

TEST_CASE("notches agree with SciPy and Octave to 1e-9 Nm at every sample") {
    check("fixed_25_50_q025", "fixed,centers=25Hz:50Hz,q=0.25");
    check("fixed_20_40_80_q2", "fixed,centers=20Hz:40Hz:80Hz,q=2");
}

TEST_CASE("low-passes of order 1, 2, 4 and 10 agree with SciPy and Octave to 1e-9 Nm at every sample") {
    check("lowpass_13rad_s_order1", "lowpass,cutoff=13rad/s");
    check("lowpass_13hz_order2", "lowpass,cutoff=13Hz,order=2");
    check("lowpass_13hz_order4", "lowpass,cutoff=13Hz,order=4");
    check("lowpass_13hz_order10", "lowpass,cutoff=13Hz,order=10");
}

TEST_CASE("the switching filter with Table 1 agrees with SciPy and Octave to 1e-9 Nm at every sample") {
    check("switching_table1_parallel", "switching,table=t,transition=parallel");
}
