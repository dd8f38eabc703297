// SPDX-License-Identifier: MIT
// Text logs as people write them: what is read, what passes byte for byte, what is refused and how.
#include <catch2/catch.hpp>
#include <memory>
#include <string>

#include "ripplenotch/core/error.hpp"
#include "ripplenotch/log/log.hpp"

using namespace ripplenotch;

namespace {

Log read_text(const std::string& text, const ReadOptions& options = {}, std::size_t piece = std::size_t(-1)) {
    return read_log(std::make_unique<ByteSource>("log.csv", std::make_shared<const std::string>(text), piece),
                    options);
}

ReadOptions by_place(std::vector<std::string> columns) {
    ReadOptions options;
    options.columns = std::move(columns);
    return options;
}

}  // namespace

TEST_CASE("a comma log with a header is read in the tool's units", "[log]") {
    const Log log = read_text(
        "time_s,velocity_rad_s,torque_Nm,position_rad\n0,1,2,0\n0.001,1,2.5,0.001\n0.002,-1,3e-1,0.002\n");
    CHECK(log.trace.time_s == std::vector<double>{0, 0.001, 0.002});
    CHECK(log.trace.torque_nm == std::vector<double>{2, 2.5, 0.3});
    CHECK(log.trace.velocity_deg_s[2] == Approx(-57.29577951308232));
    CHECK(log.trace.position_deg[1] == Approx(0.05729577951308232));
    CHECK(log.trace.sample_rate.value() == Approx(1000.0));
    CHECK(log.layout.warnings.empty());
}

TEST_CASE("each dialect of the same rows gives the same trace", "[log]") {
    const std::vector<double> torque = {2.5, -0.25, 100};
    const std::vector<std::string> dialects = {
        "time_s,velocity_deg_s,torque_nm\n0,10,2.5\n0.01,11,-0.25\n0.02,12,1e2\n",
        "time_s;velocity_deg_s;torque_nm\r\n0;10;2,5\r\n0,01;11;-0,25\r\n0,02;12;100\r\n",
        "time_s\tvelocity_deg_s\ttorque_nm\r0\t10\t2.5\r0.01\t11\t-0.25\r0.02\t12\t100\r",
        "time_s velocity_deg_s torque_nm \n 0   10  2.5 \n 0.01  11 -0.25 \n 0.02 12 100 \n",
        "time_s velocity_deg_s torque_nm\n0 10 2,5\n0,01 11 -0,25\n0,02 12 100\n",
        "time_s\tvelocity_deg_s\ttorque_nm\n0\t10\t2,5\n0,01\t11\t-0,25\n0,02\t12\t100\n",
        "\xef\xbb\xbf\"time_s\",\"velocity_deg_s\",\"torque_nm\"\r\n0,10,2.5\r\n0.01,11,-0.25\r\n0.02,12,100",
        "# rig 3\n% second\n// third\ntime_s,velocity_deg_s,torque_nm\n# before\n0,10,2.5\n# "
        "between\n0.01,11,-0.25\n\n0.02,12,100\n# end\n",
        "# time_s velocity_deg_s torque_nm\n0 10 2.5\n0.01 11 -0.25\n0.02 12 100\n",
        "time,velocity,torque\ns,deg/s,Nm\n0,10,2.5\n0.01,11,-0.25\n0.02,12,100\n",
        "time,velocity,torque\n[ms],[deg/s],[mNm]\n0,10,2500\n10,11,-250\n20,12,100000\n",
        "\"Time (ms)\";\"speed (deg/s)\";\"torque [Nm]\"\n0;10;2.5\n10;11;-0.25\n20;12;100\n",
        "\"time_s\",\"velocity_deg_s\",\"torque_nm\"\n\"0\",\"10\",\"2,5\"\n\"0,01\",\"11\",\"-0,25\"\n\"0,"
        "02\",\"12\",\"100\"\n",
        ",time_s,velocity_deg_s,torque_nm\n0,0,10,2.5\n1,0.01,11,-0.25\n2,0.02,12,100\n",
        "note,time_s,velocity_deg_s,torque_nm\n\"a, "
        "\"\"b\"\"\",0,10,2.5\nx,0.01,11,-0.25\n,0.02,12,100\nEOF\n",
    };
    for (const std::string& text : dialects) {
        INFO(text);
        const Log log = read_text(text);
        CHECK(log.trace.torque_nm == torque);
        CHECK(log.trace.velocity_deg_s == std::vector<double>{10, 11, 12});
        REQUIRE(log.trace.time_s.size() == 3);
        CHECK(log.trace.time_s[2] == Approx(0.02).epsilon(1e-15));
        CHECK(read_text(text, {}, 1).trace.torque_nm == torque);
    }
}

TEST_CASE("a log without header needs its columns by place", "[log]") {
    const std::string text = "0,10,2.5\n0.01,11,-0.25\n";
    CHECK(read_text(text, by_place({"time", "velocity", "torque"})).trace.torque_nm ==
          std::vector<double>{2.5, -0.25});
    CHECK_THROWS_AS(read_text(text), DataError);
}
