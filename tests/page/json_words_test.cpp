// SPDX-License-Identifier: MIT
#include "page/json_table.hpp"

#include "support/catch.hpp"

using namespace ripplenotch;

TEST_CASE("a value has the digits that its interval or its standard error allows") {
    // Half the interval is 0.00112: two digits of it end at the fourth decimal.
    const Json fitted = {{"value", 0.4998466893}, {"ci95", {0.4987246838, 0.5009686948}}};
    CHECK(field_text(fitted, "value") == "0.4998");
    CHECK(field_text(fitted, "ci95") == "0.4987 to 0.5010");
    const Json ratio = {{"value", 99.998765}, {"stderr", 0.00023}, {"ci95", {99.99830, 99.99923}}};
    CHECK(field_text(ratio, "value") == "99.99877");
    CHECK(field_text(ratio, "stderr") == "0.00023");
    const Json line = {{"order_output", 100.000123}, {"order_output_stderr", 0.0417}};
    CHECK(field_text(line, "order_output") == "100.000");
    CHECK(field_text(line, "order_output_stderr") == "0.042");
    const Json coarse = {{"value", 1234.5}, {"stderr", 321.0}, {"ci95", nullptr}};
    CHECK(field_text(coarse, "value") == "1234");  // an interval that there is not says nothing
}

TEST_CASE("numbers without an error have four digits, whole ones all of theirs") {
    const Json row = {
        {"rms_nm", 0.434973912}, {"speed_deg_s", 109.4951234}, {"score", 0.04798308}, {"rows", 123456789},
        {"db", 12.345678},       {"residual_hz", 1.2345678},   {"time_s", 6.503}};
    CHECK(field_text(row, "rms_nm") == "0.435");
    CHECK(field_text(row, "speed_deg_s") == "109.5");
    CHECK(field_text(row, "score") == "0.04798");
    CHECK(field_text(row, "rows") == "123456789");
    CHECK(field_text(row, "db") == "12.35");
    CHECK(field_text(row, "residual_hz") == "1.235");
    CHECK(field_text(row, "time_s") == "6.503");
}

TEST_CASE("where something is stands in one cell, without dust beside large numbers") {
    const Json where = {{"time_s", Json::array()},
                        {"speed_deg_s", {{-112.501, -0.000176435}}},
                        {"order", {1.0, 2.0}},
                        {"direction", nullptr}};
    CHECK(where_text(where) == "speed -112.5 to 0 deg/s; order 1, 2");
    CHECK(parameters_text({{"torque_nm", {{"value", 0.5}, {"ci95", {0.49, 0.51}}}}, {"order", 2.0}}) ==
          "torque 0.500 (0.490 to 0.510) Nm; order 2");
}
