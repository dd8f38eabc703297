// SPDX-License-Identifier: MIT
// Logs in which a row holds one number, files of one signal each, and columns that are paired one joint off.
#include <fmt/format.h>

#include <string>
#include <vector>

#include "log/text/long_table.hpp"
#include "log_support.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using namespace ripplenotch::test;
using Catch::Contains;

namespace {

const std::vector<double> torques = {2.5, -0.25, 100, 7};

std::string tidy(const std::string& head, const std::string& mark = ",") {
    std::string text = head + "\n";
    for (std::size_t k = 0; k < torques.size(); ++k) {
        text += fmt::format("{0}{2}velocity{2}{1}\n", 10 * k, 10 + k, mark);
        text += fmt::format("{0}{2}torque{2}{1}\n", 10 * k, torques[k], mark);
    }
    return text;
}

std::string trace(const std::string& head, const std::string& columns) {
    std::string text;
    for (const bool torque : {false, true}) {
        text += fmt::format("{}{}\n{}", head, torque ? "PLC.fTorque" : "PLC.fVelocity", columns);
        for (std::size_t k = 0; k < torques.size(); ++k)
            text += fmt::format("{};{}\n", 10 * k, torque ? torques[k] : 10.0 + static_cast<double>(k));
        text += "\n";
    }
    return text;
}

}  // namespace

TEST_CASE("a table of one value a row and a trace of one block a variable are logs of columns", "[log]") {
    const std::vector<std::string> logs = {
        tidy("time_ms,signal,value"),
        tidy("Time [ms];Variable;Value", ";"),
        tidy("timestamp\tchannel\tdata", "\t"),
        trace("", ""),
        trace("Trace;MyTrace\nVariable;", "Data type;LREAL\nTimestamp [ms];Value\n"),
        trace("", "Time [ms];Value\n"),
    };
    for (const std::string& text : logs) {
        INFO(text);
        for (const std::size_t piece : {std::size_t{3}, whole}) {
            const Log log = read_text(text, {}, piece);
            CHECK(log.trace.torque_nm == torques);
            CHECK(log.trace.velocity_deg_s == std::vector<double>{10, 11, 12, 13});
            CHECK(log.trace.time_s[3] == Approx(0.03));
            const auto& said = log.layout.inferences;
            CHECK(std::any_of(said.begin(), said.end(),
                              [](const Assumption& one) { return one.about == "shape"; }));
        }
    }
    const std::string broken = tidy("time_ms,signal,value") + "40,torque,soon\n";
    CHECK_THAT(complaint(broken),
               Contains("log.csv:10: read 'soon' as the value of 'torque', expected a number"));
    const std::string backward = tidy("time_ms,signal,value") + "20,torque,1\n";
    CHECK_THAT(complaint(backward), Contains("log.csv:10: read the time 20 of 'torque' after 30"));
}

TEST_CASE("joints of a table are told apart by their column, and others are asked about", "[log]") {
    std::string text = "time,joint,signal,run,value\n";
    for (int k = 0; k < 4; ++k)
        for (const char* joint : {"j1", "j2"})
            for (const char* signal : {"velocity_deg_s", "torque_nm"})
                text += fmt::format("{},{},{},3,{}\n", 0.01 * k, joint, signal, joint[1] == '1' ? k : 10 + k);
    ReadOptions options;
    options.joint = "j2";
    CHECK(read_text(text, options).trace.torque_nm == std::vector<double>{10, 11, 12, 13});
    CHECK_THAT(complaint(text + "0.03,j2,torque_nm,4,9\n", options),
               Contains("log.csv:18: read a second value of 'j2.torque_nm' at the time 0.03"));
}

TEST_CASE("signals with times of their own are joined to the torque's", "[log]") {
    std::string text = "time,name,value,unit\n";
    for (int k = 0; k < 20; ++k)
        text += fmt::format("{0}.5,velocity,{0},deg/s\n{1},torque,{0},Nm\n", k, k + 1);
    ReadOptions options;
    options.units = {{"time", "s"}};
    for (const auto& [how, first] : {std::pair{"linear", 0.5}, std::pair{"hold", 0.0}}) {
        options.join = how;
        const Log log = read_text(text, options);
        CHECK(log.trace.size() == 19);
        CHECK(log.trace.velocity_deg_s.front() == first);
        CHECK_THAT(log.layout.warnings.front().text, Contains("velocity has times of its own"));
    }
}

TEST_CASE("a title over two columns makes no trace of them", "[log]") {
    std::string text = "run 3\n";
    for (int k = 0; k < 9; ++k) text += fmt::format("{};{}\n", 10 + k % 2, 5 + k % 3);
    ReadOptions options = with_columns({"velocity,torque"});
    options.columns = {"velocity", "torque"};
    options.sample_rate = Hertz(100.0);
    CHECK(read_text(text, options).trace.size() == 9);
}

TEST_CASE("joints numbered from 0 and from 1 beside each other are asked about", "[log]") {
    const std::string rows = "\n0,10,11,1,2\n0.01,12,13,2,3\n0.02,14,15,3,4\n";
    const std::string mixed = "t,dq0,dq1,tau1,tau2" + rows;
    CHECK_THAT(
        complaint(mixed,
                  [] {
                      ReadOptions options;
                      options.joint = "1";
                      return options;
                  }()),
        Contains("joints are numbered from 0 and from 1") && Contains("--columns velocity=dq0,torque=tau1"));
    const Log log = read_text(mixed, with_columns({"velocity=dq1", "torque=tau2"}));
    CHECK(log.trace.torque_nm == std::vector<double>{2, 3, 4});
    CHECK_THAT(complaint("t,dq1,tau2\n0,1,2\n0.01,2,3\n"), Contains("numbered from 1 and from 2"));
    ReadOptions first;
    first.joint = "1";
    CHECK(read_text("t,dq0,dq1,dq2,tau1\n0,1,2,3,4\n0.01,1,2,3,5\n", first).trace.velocity_deg_s.front() >
          100.0);
}

TEST_CASE("several torques of one joint are listed, and parts of a torque are none", "[log]") {
    const std::string rows = "\n0,10,1,2\n0.01,11,2,3\n";
    CHECK_THAT(complaint("t,velocity,tau_sensed,tau_drive" + rows),
               Contains("--columns torque=tau_sensed or --columns torque=tau_drive"));
    CHECK(read_text("t,velocity,tau,tau_friction" + rows).trace.torque_nm == std::vector<double>{1, 2});
    CHECK_THAT(complaint("t,velocity,i,v" + rows), Contains("expected a torque column"));
}
