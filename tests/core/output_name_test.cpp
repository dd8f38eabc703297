// SPDX-License-Identifier: MIT
#include "ripplenotch/core/files.hpp"

#include "ripplenotch/core/error.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using Catch::Contains;

TEST_CASE("a name that promises another kind of file is refused with those that fit") {
    for (const char* name : {"x.csv", "a.b/x.CSV", "x.json.csv", ".hidden.csv"}) {
        CHECK_THROWS_AS(check_output_name(name, "a track", ".txt .json"), UsageError);
        CHECK_NOTHROW(check_output_name(name, "a track", ".json .csv"));
    }
    CHECK_THROWS_WITH(check_output_name("x.svg", "a track", ".csv .npy .json"),
                      Contains("-o x.svg: a track is not written as a picture; name it .csv, .npy or .json"));
    CHECK_THROWS_WITH(check_output_name("x.json", "a log", ".csv .npy"),
                      Contains("as JSON; name it .csv or .npy"));
    CHECK_THROWS_WITH(check_output_name("x.txt", "a report", ".html"), Contains("as text; name it .html"));
}

TEST_CASE("names that promise nothing are free") {
    for (const char* name : {"-", "", "x", "run.log", "x.dat", "a.csv/x", ".csv", "/dev/null", "x.2", "x."})
        CHECK_NOTHROW(check_output_name(name, "a track", ".json"));
}

TEST_CASE("an ending fits as a whole only") {
    CHECK_THROWS_AS(check_output_name("x.h", "a page", ".html .htm"), UsageError);
    CHECK_THROWS_AS(check_output_name("x.htm", "a page", ".html"), UsageError);
    CHECK_NOTHROW(check_output_name("x.h", "a header", ".html .h"));
    CHECK_NOTHROW(check_output_name("x.h", "a header", ".h .hpp"));
}
