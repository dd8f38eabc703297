// SPDX-License-Identifier: MIT
// NumPy files, against files that NumPy 1.24.2 wrote (scripts/make_npy_reference.py).
#include <cstring>
#include <string>

#include "log/npy/npy_header.hpp"
#include "log_support.hpp"
#include "ripplenotch/core/error.hpp"
#include "support/catch.hpp"
#include "support/places.hpp"

using namespace ripplenotch;
using namespace ripplenotch::test;
using Catch::Contains;

namespace {

std::string reference(const std::string& name) {
    return file_bytes(source_folder() + "/tests/log/data/" + name);
}

}  // namespace

TEST_CASE("arrays that NumPy wrote hold the rows that were put in", "[log]") {
    const std::vector<double> torque = {2.5, -0.25, 100, 0.125, -3};
    for (const std::string name :
         {"structured_f8.npy", "structured_f8_v2.npy", "structured_f8_v3.npy", "structured_big_endian_f4.npy",
          "structured_mixed.npy", "structured_aligned.npy", "plain_f8.npy", "plain_f4_three.npy"}) {
        INFO(name);
        for (const std::size_t piece : {whole, std::size_t{1}}) {
            const Log log = read_text(reference(name), {}, piece);
            CHECK(log.layout.format == "npy");
            CHECK(log.trace.torque_nm == torque);
            CHECK(log.trace.velocity_deg_s == std::vector<double>{10, 11, 12, 13, 14});
            CHECK(log.trace.time_s[4] == Approx(0.04).epsilon(1e-6));
            if (log.trace.view().has_position())
                CHECK(log.trace.position_deg[1] == Approx(0.1).epsilon(1e-6));
        }
    }
}

TEST_CASE("joints in an array column are told apart", "[log]") {
    ReadOptions options;
    CHECK_THAT(complaint(reference("structured_two_joints.npy")), Contains("2 joints (0, 1)"));
    options.joint = "j1";
    CHECK(read_text(reference("structured_two_joints.npy"), options).trace.torque_nm[4] == -3.0);
    options.joint = "0";
    CHECK(read_text(reference("structured_two_joints.npy"), options).trace.torque_nm[4] == 3.0);
}

TEST_CASE("a plain array is taken by place, with a warning, or as told", "[log]") {
    CHECK_THAT(read_text(reference("plain_f8.npy")).layout.warnings.at(0).text,
               Contains("time, velocity, torque, position by place"));
    const auto told = with_columns({"position", "-", "torque", "velocity"});
    ReadOptions options = told;
    options.sample_rate = Hertz(100.0);
    options.units = {{"velocity", "deg/s"}, {"torque", "Nm"}, {"position", "deg"}};
    const Log log = read_text(reference("plain_f8.npy"), options);
    CHECK(log.trace.velocity_deg_s[1] == 0.1);
    CHECK(log.trace.position_deg[1] == 0.01);
}

TEST_CASE("an array whose unit is looked for far ahead still comes in small blocks", "[log]") {
    constexpr std::size_t rows = 400'000, largest_block = std::size_t{1} << 18;  // 9.6 MB
    std::vector<double> numbers;
    for (std::size_t k = 0; k < rows; ++k)
        numbers.insert(numbers.end(), {0.001 * static_cast<double>(k), 50.0, static_cast<double>(k)});
    const std::string file =
        make_npy_header("'<f8'", std::to_string(rows) + ", 3", false) +
        std::string(reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(double));
    const auto reader = open_log(in_memory(file), {});
    RowBlock block;
    std::size_t row = 0;
    while (reader->next(block)) {
        CHECK(block.bytes.size() <= largest_block);
        for (const double torque : block.joints[0].torque_nm)
            if (torque != static_cast<double>(row++)) FAIL("row " << row - 1 << " has " << torque);
    }
    CHECK(row == rows);
    CHECK_THAT(complaint(file + "abc"), Contains("more bytes after the 400000 rows"));
    CHECK_THAT(complaint(file.substr(0, file.size() - 1)), Contains("a part of one"));
}

TEST_CASE("an array in Fortran order, or with a row a signal, is the same log", "[log]") {
    const Log plain = read_text(reference("plain_f8.npy"));
    const Log fortran = read_text(reference("plain_fortran.npy"));
    CHECK(fortran.trace.time_s == plain.trace.time_s);
    CHECK(fortran.trace.velocity_deg_s == plain.trace.velocity_deg_s);
    CHECK(fortran.trace.torque_nm == plain.trace.torque_nm);
    CHECK(fortran.trace.position_deg == plain.trace.position_deg);
    std::string cut = reference("plain_fortran.npy");
    cut.resize(cut.size() - 1);
    CHECK_THAT(complaint(cut), Contains("cut off"));
}

TEST_CASE("arrays that are no log are refused with the remedy", "[log]") {
    CHECK_THAT(complaint(reference("refused_objects.npy")), Contains("Python objects"));
    CHECK_THAT(complaint(reference("refused_three_dimensions.npy")), Contains("3 dimensions"));
    CHECK_THAT(complaint(reference("refused_text.npy")), Contains("no column of numbers"));
    CHECK_THAT(complaint(reference("refused_empty.npy")), Contains("without rows"));
    CHECK_THAT(complaint(reference("plain_f8.npy") + "x"), Contains("more bytes after the 5 rows"));
    std::string cut = reference("plain_f8.npy");
    cut.resize(cut.size() - 1);
    CHECK_THAT(complaint(cut), Contains("cut off"));
    std::string future = reference("plain_f8.npy");
    future[6] = 9;
    CHECK_THAT(complaint(future), Contains("version 9"));
    std::string bad = reference("structured_f8.npy");
    const double nan = std::numeric_limits<double>::quiet_NaN();
    std::memcpy(bad.data() + bad.size() - 16, &nan, 8);
    CHECK_THAT(complaint(bad), Contains("row 5, 'torque_Nm' (column 3): read nan, expected a finite number"));
    ReadOptions options;
    options.hold_bad_values = true;
    CHECK(read_text(bad, options).trace.torque_nm[4] == 0.125);
}

TEST_CASE("an array is rewritten with other torques and nothing else changed", "[log]") {
    for (const std::string name :
         {"structured_f8.npy", "structured_f8_v2.npy", "structured_big_endian_f4.npy",
          "structured_aligned.npy", "plain_f8.npy", "plain_f4_three.npy"}) {
        INFO(name);
        const std::string bytes = reference(name);
        CHECK(rewritten(bytes, same) == bytes);
        const std::string twice = rewritten(bytes, doubled);
        CHECK(twice.size() == bytes.size());
        CHECK(read_text(twice).trace.torque_nm == std::vector<double>{5, -0.5, 200, 0.25, -6});
        CHECK(rewritten(twice, [](double torque) { return 0.5 * torque; }) == bytes);
        WriteOptions append;
        append.append = true;
        const std::string wider = rewritten(bytes, doubled, append);
        CHECK(npy_header_size(wider) % 64 == 0);
        if (name.find("plain") == std::string::npos) {
            CHECK(read_text(wider).trace.torque_nm == read_text(bytes).trace.torque_nm);
            CHECK(read_text(wider, with_columns({"torque=torque_filtered_Nm"})).trace.torque_nm ==
                  read_text(twice).trace.torque_nm);
        }
    }
    CHECK_THROWS_WITH(rewritten(reference("structured_mixed.npy"), doubled),
                      Contains("integers") && Contains("--append"));
}

TEST_CASE("a damaged header is refused and never more memory than the file deserves is taken", "[log]") {
    const auto header = [](const std::string& dictionary) {
        std::string text = dictionary;
        text.resize(118, ' ');
        return std::string("\x93NUMPY\x01\x00\x76\x00", 10) + text;
    };
    for (const std::string dictionary :
         {"{'descr': '<f8', 'fortran_order': False, 'shape': (99999999999999999999999, 3), }",
          "{'descr': '<f8', 'fortran_order': False, 'shape': (4611686018427387904, 3), }",
          "{'descr': '<f8', 'fortran_order': False, 'shape': (3, 999999999), }",
          "{'descr': '<f99999999999999999', 'fortran_order': False, 'shape': (3, 3), }",
          "{'descr': [('a', '<f8', (99999999, 99999999))], 'shape': (3,), }",
          "{'descr': [('a', [('b', '<f8')])], 'shape': (3,), }", "{'descr': '<f8'", "{", "", "{'descr': [(",
          "{'x': 1}", "{'descr': '', 'shape': (1,3)}", "{'shape': (1,3)}", "{'descr': '<f8', 'shape': ()}"}) {
        INFO(dictionary);
        CHECK_FALSE(complaint(header(dictionary)).empty());
    }
}
