// SPDX-License-Identifier: MIT
// Chains as people have them: the same arm in every dialect is the same arm, and what is no arm is refused.
#include <filesystem>
#include <fstream>

#include "arm_support.hpp"
#include "ripplenotch/arm/chain.hpp"
#include "ripplenotch/core/error.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using namespace ripplenotch::test;
using Catch::Contains;
using Catch::Matchers::WithinAbs;

namespace {

// Three joints with every parameter in use: Craig's table, and the same with the frames put elsewhere.
const std::string three_mdh =
    "# of the "
    "maker\njoint,a_m,alpha_deg,d_m,theta_deg\n\nbase,0,0,0.3,10\nupper,0.1,-90,0.05,20\nlower,0.4,30,-0.1,-"
    "40\n";
const std::string three_urdf = R"(<?xml version="1.0"?>
<robot name="three">
  <link name="world"/><link name="a"/><link name="b"/><link name="c"/><link name="flange"/><link name="camera"/>
  <joint name="base" type="continuous">
    <parent link="world"/><child link="a"/>
    <origin xyz="0 0 0.3" rpy="0 0 0.17453292519943295"/><axis xyz="0 0 1"/>
  </joint>
  <joint name="stand" type="fixed">
    <parent link="a"/><child link="bracket"/><origin xyz="0.1 0 0" rpy="-1.5707963267948966 0 0"/>
  </joint>
  <joint name="upper" type="revolute">
    <parent link="bracket"/><child link="b"/>
    <origin xyz="0 0 0.05" rpy="0 0 0.3490658503988659"/><axis xyz="0 0 2"/>
    <limit lower="-1.5707963267948966" upper="3.141592653589793" effort="1" velocity="1"/>
  </joint>
  <joint name="tilt" type="fixed">
    <parent link="b"/><child link="rib"/>
    <origin xyz="0.4 0.05 -0.08660254037844387" rpy="0.5235987755982988 0 0"/>
  </joint>
  <joint name="lower" type="revolute">
    <parent link="rib"/><child link="c"/>
    <origin rpy="0 0 -0.6981317007977318"/><axis xyz="0 0 1"/>
  </joint>
  <joint name="end" type="fixed"><parent link="c"/><child link="flange"/></joint>
  <joint name="view" type="fixed"><parent link="flange"/><child link="camera"/></joint>
</robot>)";
const std::string three_mjcf = R"(<mujoco model="three">
  <compiler angle="degree"/>
  <option gravity="0 0 -9.81"/>
  <default><joint axis="0 0 1" damping="1"/><default class="upside"><joint axis="0 0 -1"/></default></default>
  <worldbody><light pos="0 0 3"/>
    <body name="a" pos="0 0 0.3" euler="0 0 10"><joint name="base"/>
      <geom type="box" size="1 1 1"/>
      <body name="b" pos="0.1 0.05 0" euler="-90 0 20"><joint name="upper" range="-90 180"/>
        <body name="c" pos="0.4 0.05 -0.08660254037844387" quat="0.9659258262890683 0.25881904510252074 0 0"
              childclass="upside">
          <joint name="lower" ref="40" class="upside" axis="0 0 1"/>
        </body>
      </body>
    </body>
  </worldbody>
</mujoco>)";

// The same torque for the same masses wherever the arm goes. Frames may be turned about a joint's axis from
// dialect to dialect, so links whose values such a turn leaves alone: bodies of revolution about z.
void require_same_arm(const Chain& one, const Chain& other) {
    REQUIRE(one.size() == other.size());
    std::vector<double> links;
    for (std::size_t j = 0; j < one.size(); ++j)
        for (const double value : {2.0, 0.0, 0.0, 0.3, 0.4, 0.0, 0.0, 0.4, 0.0, 0.1}) links.push_back(value);
    const auto motions = fourier_motions(one.size(), 2.0, 50.0, 8);
    for (std::size_t joint = 0; joint < one.size(); ++joint) {
        const auto a = arm_torque(one, links, motions, joint), b = arm_torque(other, links, motions, joint);
        for (std::size_t k = 0; k < a.size(); ++k) REQUIRE_THAT(a[k], WithinAbs(b[k], 1e-9));
    }
}

std::string urdf_joint(const std::string& name, const std::string& type, const std::string& parent,
                       const std::string& child, const std::string& more = "") {
    return "<joint name=\"" + name + "\" type=\"" + type + "\"><parent link=\"" + parent +
           "\"/><child link=\"" + child + "\"/>" + more + "</joint>\n";
}

Chain urdf(const std::string& joints, const std::optional<std::string>& tip = std::nullopt) {
    return chain_of_urdf("robot.urdf", "<robot name=\"r\">\n" + joints + "</robot>", tip);
}

Chain mjcf(const std::string& inside, const std::optional<std::string>& tip = std::nullopt) {
    return chain_of_mjcf("robot.xml", "<mujoco>" + inside + "</mujoco>", tip);
}

}  // namespace

TEST_CASE("one arm in Craig's table, URDF and MJCF is one arm", "[arm]") {
    const Chain table = chain_of_mdh("three.csv", three_mdh);
    CHECK(table.joints[1].name == "upper");
    const Chain robot = chain_of_urdf("three.urdf", three_urdf, std::nullopt);
    require_same_arm(table, robot);
    REQUIRE(robot.joints[1].limits);
    CHECK_THAT(robot.joints[1].limits->first, WithinAbs(-90.0, 1e-12));
    CHECK_FALSE(robot.joints[0].limits);
    // What the table turns by -40 deg, MuJoCo writes as a joint that stands at 40 deg in the file.
    require_same_arm(table, chain_of_mjcf("three.xml", three_mjcf, std::nullopt));
}

TEST_CASE("a joint of an MJCF may sit anywhere in its body", "[arm]") {
    const std::string elbow = "<joint axis=\"0 1 0\"/></body></body></worldbody>";
    const Chain beside =
        mjcf("<worldbody><body pos=\"0.5 0 0\"><joint name=\"a\" pos=\"-0.2 0 0\"/><body pos=\"0.3 0 0.1\">" +
             elbow);
    const Chain within =
        mjcf("<worldbody><body pos=\"0.3 0 0\"><joint name=\"a\"/><body pos=\"0.5 0 0.1\">" + elbow);
    CHECK(beside.joints[0].origin_m == within.joints[0].origin_m);
    for (std::size_t i = 0; i < 3; ++i)
        CHECK_THAT(beside.joints[1].origin_m[i], WithinAbs(within.joints[1].origin_m[i], 1e-15));
}

TEST_CASE("one arm in the standard table and in Craig's is one arm", "[arm]") {
    // The standard table of a row later: a and alpha of Craig's next row; the last ones are the tool's.
    const Chain standard = chain_of_dh(
        "dh.csv", "theta_deg,d_m,a_m,alpha_deg\n10,0.3,0.1,-90\n20,0.05,0.4,30\n-40,-0.1,0.7,80\n");
    require_same_arm(chain_of_mdh("three.csv", three_mdh), standard);
}

TEST_CASE("a word of axes says directions, and lengths that are guessed", "[arm]") {
    const Chain chain = chain_of_axes("zyX", 0.25);
    CHECK(chain.lengths_are_guessed);
    CHECK(chain.joints[0].origin_m == Vector3{0, 0, 0});
    CHECK(chain.joints[2].origin_m == Vector3{0, 0, 0.25});
    CHECK(chain.joints[1].axis == Vector3{0, 1, 0});
    CHECK(chain.joints[2].axis == Vector3{-1, 0, 0});
    CHECK_THROWS_WITH(chain_of_axes("zyw"), Contains("'w' in zyw is none of x, y, z"));
    CHECK_THROWS_AS(chain_of_axes(""), UsageError);
    CHECK_THROWS_AS(chain_of_axes(std::string(1000000, 'z')), UsageError);
}

TEST_CASE("angles of roll, pitch and yaw go there and back", "[arm]") {
    for (const Vector3 rpy :
         {Vector3{10, 20, 30}, Vector3{-170, 80, 100}, Vector3{0, 90, 40}, Vector3{0, -90, -40}}) {
        const Rotation turn = rotation_of_rpy(rpy), again = rotation_of_rpy(rpy_of_rotation(turn));
        for (std::size_t e = 0; e < 9; ++e) CHECK_THAT(again[e], WithinAbs(turn[e], 1e-14));
    }
    // Yaw last: x goes to y.
    CHECK_THAT(rotation_of_rpy({0, 0, 90})[3], WithinAbs(1.0, 1e-15));
}

TEST_CASE("what a URDF cannot mean is said with its place", "[arm][broken]") {
    const std::string turns = urdf_joint("a", "revolute", "base", "one", "<axis xyz=\"0 0 1\"/>");
    CHECK_THROWS_WITH(urdf(""), Contains("robot.urdf: no joint moves"));
    CHECK_THROWS_WITH(chain_of_urdf("robot.urdf.xacro", "<robot>\n<xacro:property name=\"x\"/></robot>", {}),
                      Contains("robot.urdf.xacro holds macros (xacro:property, line 2); expand it first: "
                               "xacro robot.urdf.xacro > robot.urdf"));
    CHECK_THROWS_WITH(urdf(turns + urdf_joint("b", "revolute", "one", "left") +
                           urdf_joint("c", "prismatic", "one", "right")),
                      Contains("more than one end (left, right); state at which link with tip=left, or "
                               "tip=one, before they part"));
    CHECK(
        urdf(turns + urdf_joint("b", "revolute", "one", "left") + urdf_joint("c", "revolute", "one", "right"),
             "right")
            .joints[1]
            .name == "c");
    CHECK_THROWS_WITH(urdf(turns, "onne"), Contains("has no link 'onne' (did you mean one?)"));
    CHECK_THROWS_WITH(urdf(turns + urdf_joint("b", "floating", "one", "two")),
                      Contains("robot.urdf:3: joint 'b' is floating"));
    CHECK_THROWS_WITH(urdf(turns + urdf_joint("b", "planar", "one", "two")), Contains("'b' is planar"));
    CHECK_THROWS_WITH(urdf(turns + urdf_joint("b", "revolute", "one", "two", "<mimic joint=\"a\"/>")),
                      Contains("'b' follows another one (mimic a)") && Contains("tip=one"));
    CHECK_THROWS_WITH(urdf(urdf_joint("a", "revolute", "x", "y") + urdf_joint("b", "revolute", "y", "x")),
                      Contains("goes round in a circle"));
    CHECK_THROWS_WITH(urdf(turns + urdf_joint("b", "revolute", "two", "one")),
                      Contains("hangs on two joints, 'a' and 'b'"));
    CHECK_THROWS_WITH(urdf(turns + urdf_joint("b", "hinge", "one", "two")), Contains("of type 'hinge'"));
    CHECK_THROWS_WITH(urdf(urdf_joint("a", "revolute", "base", "one", "<axis xyz=\"0 0 0\"/>")),
                      Contains("has no direction"));
    CHECK_THROWS_WITH(urdf(urdf_joint("a", "revolute", "base", "one", "<axis xyz=\"0 0 nan\"/>")),
                      Contains("finite"));
    CHECK_THROWS_WITH(urdf(urdf_joint("a", "revolute", "base", "one", "<origin xyz=\"0 333 0\"/>")),
                      Contains("lengths are in metres"));
    CHECK_THROWS_WITH(urdf(urdf_joint("a", "revolute", "base", "one", "<origin rpy=\"0 0\"/>")),
                      Contains("origin rpy=\"0 0\", expected 3 finite numbers"));
    CHECK_THROWS_WITH(urdf(turns + urdf_joint("a", "revolute", "one", "two")),
                      Contains("two joints are named 'a'"));
    CHECK_THROWS_WITH(chain_of_urdf("r.urdf", "<robot>\n <joint", {}),
                      Contains("r.urdf:2:") && Contains("no XML"));
    CHECK_THROWS_WITH(chain_of_urdf("r.urdf", "", {}), Contains("no XML"));
    CHECK_THROWS_WITH(chain_of_urdf("r.urdf", "<mujoco/>", {}), Contains("that is --arm mjcf"));
    CHECK_THROWS_WITH(urdf("<joint name=\"a\"/>"), Contains("joint without type"));
}

TEST_CASE("a stranger's description takes neither the stack nor the memory", "[arm][broken]") {
    std::string deep, chain;
    for (int k = 0; k < 100000; ++k) deep += "<body>";
    CHECK_THROWS_WITH(chain_of_urdf("r.urdf", "<robot>" + deep, {}), Contains("no XML"));
    for (int k = 0; k < 100000; ++k) deep += "</body>";
    CHECK_THROWS_WITH(chain_of_mjcf("r.xml", "<mujoco>" + deep + "</mujoco>", {}),
                      Contains("100 elements within"));
    for (int k = 0; k < 30; ++k)
        chain += urdf_joint("j" + std::to_string(k), "revolute", std::to_string(k), std::to_string(k + 1));
    CHECK_THROWS_WITH(urdf(chain), Contains("30 moving joints"));
    std::string fixed;
    for (int k = 0; k < 30000; ++k)
        fixed += urdf_joint("j", "fixed", std::to_string(k), std::to_string(k + 1));
    CHECK(urdf(fixed + urdf_joint("a", "revolute", "30000", "end")).size() == 1);
    std::string wide;
    for (int k = 0; k < 200001; ++k) wide += "<a/>";
    CHECK_THROWS_WITH(urdf(wide), Contains("more than 200000 elements"));
    CHECK_THROWS_WITH(urdf("<!DOCTYPE r [<!ENTITY a \"aaaa\"><!ENTITY b \"&a;&a;\">]>&b;"),
                      Contains("no XML") || Contains("no joint"));
    std::string table = "a_m,alpha_deg,d_m,theta_deg\n";
    for (int k = 0; k < 30; ++k) table += "0,0,0,0\n";
    CHECK_THROWS_WITH(chain_of_dh("dh.csv", table), Contains("more than 20 joints"));
    const auto path = std::filesystem::temp_directory_path() / "ripplenotch_large_description";
    std::ofstream(path) << std::string((16 << 20) + 1, ' ');
    CHECK_THROWS_WITH(read_chain_file(path.string()), Contains("larger than 16 MB"));
    std::filesystem::remove(path);
}

TEST_CASE("every beginning of a description is read or refused", "[arm][broken]") {
    for (std::size_t size = 0; size < three_urdf.size(); ++size)
        CHECK_THROWS_AS(chain_of_urdf("r", three_urdf.substr(0, size), {}), Error);
    for (std::size_t size = 0; size < three_mjcf.size(); ++size)
        CHECK_THROWS_AS(chain_of_mjcf("r", three_mjcf.substr(0, size), {}), Error);
}

TEST_CASE("what an MJCF cannot mean is said with its place", "[arm][broken]") {
    CHECK_THROWS_WITH(mjcf("<worldbody/>"), Contains("no body"));
    CHECK_THROWS_WITH(mjcf("<worldbody><body name=\"a\"><freejoint/></body></worldbody>"),
                      Contains("is free"));
    CHECK_THROWS_WITH(mjcf("<worldbody><body name=\"a\"><joint type=\"ball\"/></body></worldbody>"),
                      Contains("is ball"));
    CHECK_THROWS_WITH(mjcf("<include file=\"x.xml\"/>"), Contains("'include' is not understood"));
    CHECK_THROWS_WITH(mjcf("<compiler eulerseq=\"xyw\"/><worldbody/>"), Contains("eulerseq is 'xyw'"));
    CHECK_THROWS_WITH(mjcf("<worldbody><body quat=\"0 0 0 0\"><joint/></body></worldbody>"),
                      Contains("has no direction"));
    CHECK_THROWS_WITH(mjcf("<worldbody><body><joint range=\"1\"/></body></worldbody>"),
                      Contains("expected 2 finite numbers"));
    CHECK_THROWS_WITH(
        mjcf("<worldbody><body name=\"a\"><joint/><body name=\"l\"><joint name=\"x\"/></body><body "
             "name=\"r\"><joint name=\"y\"/></body></body></worldbody>"),
        Contains("more than one end (l, r); state at which body"));
    CHECK_THROWS_WITH(chain_of_mjcf("r.xml", "<robot/>", {}), Contains("that is --arm urdf"));
}

TEST_CASE("orientations of an MJCF in five ways are one", "[arm]") {
    const auto turn = [](const std::string& how, const std::string& compiler = "") {
        return mjcf(compiler + "<worldbody><body " + how + "><joint/></body></worldbody>")
            .joints.front()
            .rotation;
    };
    const Rotation wanted = turn("euler=\"0 0 90\"");
    CHECK_THAT(wanted[3], WithinAbs(1.0, 1e-15));
    for (const Rotation& same :
         {turn("quat=\"2 0 0 2\""), turn("axisangle=\"0 0 3 90\""), turn("xyaxes=\"0 2 0 -1 1 0\""),
          turn("euler=\"0 0 1.5707963267948966\"", "<compiler angle=\"radian\"/>"),
          turn("euler=\"90 0 0\"", "<compiler eulerseq=\"zyx\"/>")})
        for (std::size_t e = 0; e < 9; ++e) CHECK_THAT(same[e], WithinAbs(wanted[e], 1e-12));
    // Axes that move and axes that stay: the same three turns the other way round.
    const Rotation moving = turn("euler=\"10 20 30\""),
                   staying = turn("euler=\"30 20 10\"", "<compiler eulerseq=\"ZYX\"/>");
    for (std::size_t e = 0; e < 9; ++e) CHECK_THAT(staying[e], WithinAbs(moving[e], 1e-12));
    const Rotation leaning = turn("zaxis=\"1 0 0\"");
    CHECK_THAT(leaning[2], WithinAbs(1.0, 1e-12));
    CHECK_THAT(leaning[4], WithinAbs(1.0, 1e-12));
}

TEST_CASE("a table of Denavit and Hartenberg is read to the letter", "[arm][broken]") {
    CHECK_THROWS_WITH(chain_of_dh("dh.csv", ""), Contains("expected the header a_m,alpha_deg,d_m,theta_deg"));
    CHECK_THROWS_WITH(chain_of_dh("dh.csv", "a,alpha,d,theta\n"), Contains("dh.csv:1: read the column 'a'"));
    CHECK_THROWS_WITH(chain_of_dh("dh.csv", "a_m,alpha_deg,d_m\n"), Contains("has no theta_deg"));
    CHECK_THROWS_WITH(chain_of_dh("dh.csv", "a_m,alpha_deg,d_m,theta_deg\n1,2,3\n"),
                      Contains("dh.csv:2: 3 cells, expected 4"));
    CHECK_THROWS_WITH(chain_of_dh("dh.csv", "a_m,alpha_deg,d_m,theta_deg\n1,2,inf,3\n"),
                      Contains("dh.csv:2: d_m is 'inf'"));
    CHECK_THROWS_WITH(chain_of_dh("dh.csv", "a_m,alpha_deg,d_m,theta_deg\n"), Contains("no joint moves"));
}

namespace {

using Names = std::vector<std::string>;
using Places = std::vector<std::size_t>;

Chain chain_of(const Names& names) {
    Chain chain = chain_of_axes(std::string(names.size(), 'z'));
    chain.source = "robot.urdf";
    for (std::size_t j = 0; j < names.size(); ++j) chain.joints[j].name = names[j];
    return chain;
}

JointMatch match(const Names& chain, const Names& log, const StatedJoints& stated = {}) {
    return match_joints(chain_of(chain), log, stated, "log.csv");
}

}  // namespace

TEST_CASE("joints of the same name are one, whatever their spelling", "[arm]") {
    const JointMatch found =
        match({"shoulder_pan_joint", "elbow_joint"}, {"Elbow", "gripper", "Shoulder-Pan"});
    CHECK(found.of == Places{2, 0});
    CHECK(found.rule == "by name");
    CHECK(found.option == "joints=shoulder_pan_joint:Shoulder-Pan|elbow_joint:Elbow");
    CHECK(found.warnings.empty());
    REQUIRE(found.notes.size() == 1);
    CHECK_THAT(found.notes[0], Contains("'gripper' of the log is not part of the chain"));
    CHECK(match({"panda_joint1", "panda_joint2"}, {"panda2", "panda1"}).of == Places{1, 0});
}

TEST_CASE("joints of the same number are one, counted from 0 or 1", "[arm]") {
    const JointMatch one = match({"panda_joint1", "panda_joint2"}, {"q1", "q2"});
    CHECK(one.of == Places{0, 1});
    CHECK(one.rule == "by number");
    CHECK(match({"panda_joint1", "panda_joint2"}, {"q1", "q0"}).of == Places{1, 0});
    CHECK(match({"a0", "a1"}, {"q2", "q1"}).of == Places{1, 0});
    // From 1 as long as that finds them all, though there is a 0.
    CHECK(match({"a1", "a2"}, {"q0", "q1", "q2"}).of == Places{1, 2});
}

TEST_CASE("joints without anything in common go by their order, and that is said", "[arm]") {
    const JointMatch found = match({"base", "boom"}, {"left", "right"});
    CHECK(found.of == Places{0, 1});
    CHECK(found.rule == "by order");
    REQUIRE(found.warnings.size() == 1);
    CHECK_THAT(found.warnings[0], Contains("paired in order: base:left, boom:right"));
    // Not where a third joint leaves open which two.
    CHECK_THROWS_AS(match({"base", "boom"}, {"left", "right", "hand"}), UsageError);
}

TEST_CASE("stated joints go before any rule, which finds the others", "[arm]") {
    const JointMatch found = match({"j1", "j2", "j3"}, {"1", "2", "x"}, {{"j2", "x"}, {"j3", "2"}});
    CHECK(found.of == Places{0, 2, 1});
    CHECK(match({"j1"}, {"x"}, {{"j1", "x"}}).rule == "as stated");
    CHECK_THROWS_WITH(match({"j1"}, {"x"}, {{"k", "x"}}),
                      Contains("'k' is no joint of robot.urdf; moving joints: j1"));
    CHECK_THROWS_WITH(match({"j1"}, {"elbow"}, {{"j1", "elbou"}}), Contains("did you mean elbow?"));
    CHECK_THROWS_WITH(match({"j1", "j2"}, {"x", "y"}, {{"j1", "x"}, {"j2", "x"}}),
                      Contains("has a partner already"));
}

TEST_CASE("a joint without a partner is named, with what the log has", "[arm]") {
    CHECK_THROWS_WITH(match({"panda_joint1", "panda_joint2", "panda_joint3"}, {"1", "3"}),
                      Contains("robot.urdf has the joint 'panda_joint2', and log.csv holds no position of it "
                               "(its joints: 1, 3); name it with joints=panda_joint2:NAME, or keep it still "
                               "in the model with joints=panda_joint2:=0deg"));
    // The same number twice is no answer.
    CHECK_THROWS_AS(match({"a1", "b1", "c"}, {"1", "2"}), UsageError);
}

// The torque of an arm against mechanics worked out another way.

namespace {

// The energies of an arm at one moment by its positions alone: where each link's frame is, by multiplying
// transforms, and how fast, by differences of it. Nothing of the recursion is in it.
struct Pose {
    std::vector<Vector3> origin;
    std::vector<Rotation> turn;
};

Rotation product(const Rotation& a, const Rotation& b) {
    Rotation c{};
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j)
            for (std::size_t k = 0; k < 3; ++k) c[3 * i + j] += a[3 * i + k] * b[3 * k + j];
    return c;
}

Vector3 turned(const Rotation& r, const Vector3& v) {
    Vector3 out{};
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t k = 0; k < 3; ++k) out[i] += r[3 * i + k] * v[k];
    return out;
}

// Rodrigues' formula, element by element.
Rotation rotation(const Vector3& u, double angle) {
    const double c = std::cos(angle), s = std::sin(angle), v = 1.0 - c;
    return {c + u[0] * u[0] * v,        u[0] * u[1] * v - u[2] * s, u[0] * u[2] * v + u[1] * s,
            u[1] * u[0] * v + u[2] * s, c + u[1] * u[1] * v,        u[1] * u[2] * v - u[0] * s,
            u[2] * u[0] * v - u[1] * s, u[2] * u[1] * v + u[0] * s, c + u[2] * u[2] * v};
}

Pose pose(const Chain& chain, const std::vector<double>& q) {
    Pose found;
    Vector3 origin{};
    Rotation turn{1, 0, 0, 0, 1, 0, 0, 0, 1};
    for (std::size_t j = 0; j < chain.size(); ++j) {
        const ChainJoint& joint = chain.joints[j];
        const Vector3 step = turned(turn, joint.origin_m);
        for (std::size_t i = 0; i < 3; ++i) origin[i] += step[i];
        turn = product(turn, joint.rotation);
        if (joint.kind == JointKind::revolute) {
            turn = product(turn, rotation(joint.axis, q[j]));
        } else {
            const Vector3 slide = turned(turn, joint.axis);
            for (std::size_t i = 0; i < 3; ++i) origin[i] += q[j] * slide[i];
        }
        found.origin.push_back(origin);
        found.turn.push_back(turn);
    }
    return found;
}

double kinetic(const Chain& chain, const std::vector<double>& links, const std::vector<double>& q,
               const std::vector<double>& qd) {
    constexpr double h = 1e-4;
    std::vector<double> before = q, after = q;
    for (std::size_t j = 0; j < q.size(); ++j) before[j] -= h * qd[j], after[j] += h * qd[j];
    const Pose now = pose(chain, q), early = pose(chain, before), late = pose(chain, after);
    double energy = 0.0;
    for (std::size_t j = 0; j < chain.size(); ++j) {
        const double* const p = links.data() + 10 * j;
        Vector3 v{};
        Rotation change{};
        for (std::size_t i = 0; i < 3; ++i) v[i] = (late.origin[j][i] - early.origin[j][i]) / (2.0 * h);
        for (std::size_t i = 0; i < 9; ++i) change[i] = (late.turn[j][i] - early.turn[j][i]) / (2.0 * h);
        // R' dR is the cross product with the speed of turning, in the link's frame.
        const Rotation& r = now.turn[j];
        const Rotation spin = product({r[0], r[3], r[6], r[1], r[4], r[7], r[2], r[5], r[8]}, change);
        const Vector3 w{spin[7], spin[2], spin[3]}, mc = turned(r, {p[1], p[2], p[3]}), w_out = turned(r, w);
        const Vector3 crossed{w_out[1] * mc[2] - w_out[2] * mc[1], w_out[2] * mc[0] - w_out[0] * mc[2],
                              w_out[0] * mc[1] - w_out[1] * mc[0]};
        energy += 0.5 * p[0] * (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) + v[0] * crossed[0] +
                  v[1] * crossed[1] + v[2] * crossed[2] +
                  0.5 * (p[4] * w[0] * w[0] + p[7] * w[1] * w[1] + p[9] * w[2] * w[2]) + p[5] * w[0] * w[1] +
                  p[6] * w[0] * w[2] + p[8] * w[1] * w[2];
    }
    return energy;
}

double potential(const Chain& chain, const std::vector<double>& links, const std::vector<double>& q) {
    const Pose now = pose(chain, q);
    double energy = 0.0;
    for (std::size_t j = 0; j < chain.size(); ++j) {
        const double* const p = links.data() + 10 * j;
        const Vector3 mc = turned(now.turn[j], {p[1], p[2], p[3]});
        for (std::size_t i = 0; i < 3; ++i)
            energy -= chain.gravity_m_s2[i] * (p[0] * now.origin[j][i] + mc[i]);
    }
    return energy;
}

// d/dt dT/dqd - dT/dq + dV/dq by central differences.
double lagrange(const Chain& chain, const std::vector<double>& links, const std::vector<double>& q,
                const std::vector<double>& qd, const std::vector<double>& qdd, std::size_t joint) {
    constexpr double h = 1e-3;
    const auto momentum = [&](double t) {
        std::vector<double> at = q, fast = qd, slow = qd;
        for (std::size_t j = 0; j < q.size(); ++j) {
            at[j] += t * qd[j] + 0.5 * t * t * qdd[j];
            fast[j] += t * qdd[j];
            slow[j] += t * qdd[j];
        }
        fast[joint] += h;
        slow[joint] -= h;
        return (kinetic(chain, links, at, fast) - kinetic(chain, links, at, slow)) / (2.0 * h);
    };
    std::vector<double> up = q, down = q;
    up[joint] += h;
    down[joint] -= h;
    const double of_place = (kinetic(chain, links, up, qd) - kinetic(chain, links, down, qd)) / (2.0 * h);
    const double of_height = (potential(chain, links, up) - potential(chain, links, down)) / (2.0 * h);
    return (momentum(h) - momentum(-h)) / (2.0 * h) - of_place + of_height;
}

Chain random_chain(std::size_t joints, unsigned seed, bool slides) {
    std::mt19937_64 random(seed);
    const auto uniform = [&] { return 0x1p-52 * static_cast<double>(random() >> 11) - 1.0; };
    Chain chain{.source = "random", .joints = {}, .gravity_m_s2 = {1.0, -2.0, -9.0}};
    for (std::size_t j = 0; j < joints; ++j) {
        ChainJoint joint{"j" + std::to_string(j + 1)};
        if (slides && j % 3 == 1) joint.kind = JointKind::prismatic;
        joint.origin_m = {0.4 * uniform(), 0.4 * uniform(), 0.4 * uniform()};
        joint.rotation = rotation_of_rpy({180.0 * uniform(), 180.0 * uniform(), 180.0 * uniform()});
        joint.axis = {uniform(), uniform(), uniform()};
        chain.joints.push_back(joint);
    }
    settle_chain(chain);
    return chain;
}

void require_lagrange(const Chain& chain, unsigned seed) {
    const std::size_t n = chain.size();
    const std::vector<double> links = random_links(n, seed);
    std::vector<Motion> motions = fourier_motions(n, 3.0, 2.0, seed);
    for (std::size_t j = 0; j < n; ++j) {
        if (chain.joints[j].kind == JointKind::revolute) continue;
        for (auto* values :
             {&motions[j].position_deg, &motions[j].velocity_deg_s, &motions[j].acceleration_deg_s2})
            for (double& value : *values) value *= 0.01;  // metres
    }
    for (std::size_t joint = 0; joint < n; ++joint) {
        const auto torque_nm = arm_torque(chain, links, motions, joint);
        for (std::size_t k = 0; k < torque_nm.size(); ++k) {
            std::vector<double> q, qd, qdd;
            for (std::size_t j = 0; j < n; ++j) {
                const double unit = chain.joints[j].kind == JointKind::revolute ? radians : 1.0;
                q.push_back(unit * motions[j].position_deg[k]);
                qd.push_back(unit * motions[j].velocity_deg_s[k]);
                qdd.push_back(unit * motions[j].acceleration_deg_s2[k]);
            }
            INFO("joint " << joint << ", sample " << k);
            REQUIRE_THAT(torque_nm[k], WithinAbs(lagrange(chain, links, q, qd, qdd, joint), 2e-4));
        }
    }
}

double mean_difference(const std::vector<double>& a, const std::vector<double>& b) {
    double sum = 0.0;
    for (std::size_t k = 0; k < a.size(); ++k) sum += std::abs(a[k] - b[k]);
    return sum / static_cast<double>(a.size());
}

}  // namespace

TEST_CASE("a planar arm of two links has the torque of the textbooks", "[arm]") {
    // Two links in the xz plane that turn about y, each a mass m at its far end l: Spong, Robot Modeling and
    // Control, 2006, section 7.4, with gravity along -z and angles from the x axis downward.
    Chain chain{.source = "two links", .joints = {{"a"}, {"b"}}};
    chain.joints[0].axis = chain.joints[1].axis = {0, 1, 0};
    const double m1 = 2.0, m2 = 1.5, l1 = 0.4, l2 = 0.3, g = 9.81;
    chain.joints[1].origin_m = {l1, 0, 0};
    settle_chain(chain);
    const std::vector<double> links = {m1, m1 * l1, 0, 0, 0, 0, 0, m1 * l1 * l1, 0, m1 * l1 * l1,
                                       m2, m2 * l2, 0, 0, 0, 0, 0, m2 * l2 * l2, 0, m2 * l2 * l2};
    const auto motions = fourier_motions(2, 10.0, 20.0, 3);
    const auto first = arm_torque(chain, links, motions, 0), second = arm_torque(chain, links, motions, 1);
    for (std::size_t k = 0; k < first.size(); ++k) {
        const double q1 = radians * motions[0].position_deg[k], q2 = radians * motions[1].position_deg[k];
        const double v1 = radians * motions[0].velocity_deg_s[k], v2 = radians * motions[1].velocity_deg_s[k];
        const double a1 = radians * motions[0].acceleration_deg_s2[k],
                     a2 = radians * motions[1].acceleration_deg_s2[k];
        const double m12 = m2 * (l2 * l2 + l1 * l2 * std::cos(q2)), h = m2 * l1 * l2 * std::sin(q2);
        const double m11 = (m1 + m2) * l1 * l1 + m2 * l2 * l2 + 2.0 * m2 * l1 * l2 * std::cos(q2);
        REQUIRE_THAT(first[k],
                     WithinAbs(m11 * a1 + m12 * a2 - h * (2.0 * v1 * v2 + v2 * v2) -
                                   g * ((m1 + m2) * l1 * std::cos(q1) + m2 * l2 * std::cos(q1 + q2)),
                               1e-12));
        REQUIRE_THAT(
            second[k],
            WithinAbs(m12 * a1 + m2 * l2 * l2 * a2 + h * v1 * v1 - g * m2 * l2 * std::cos(q1 + q2), 1e-12));
    }
}

TEST_CASE("the torque of a random arm is what its energies change by", "[arm]") {
    require_lagrange(random_chain(5, 11, false), 12);
    require_lagrange(random_chain(5, 13, true), 14);
}

TEST_CASE("what the joints give is what the arm's energy gains", "[arm]") {
    const Chain chain = random_chain(6, 21, false);
    const auto links = random_links(6, 22);
    const auto motions = fourier_motions(6, 2.0, 1000.0, 23);
    std::vector<std::vector<double>> torque_nm;
    for (std::size_t j = 0; j < 6; ++j) torque_nm.push_back(arm_torque(chain, links, motions, j));
    const auto energy = [&](std::size_t k) {
        std::vector<double> q, qd;
        for (const Motion& motion : motions) {
            q.push_back(radians * motion.position_deg[k]);
            qd.push_back(radians * motion.velocity_deg_s[k]);
        }
        return kinetic(chain, links, q, qd) + potential(chain, links, q);
    };
    const auto power = [&](std::size_t k) {
        double sum = 0.0;
        for (std::size_t j = 0; j < 6; ++j) sum += torque_nm[j][k] * radians * motions[j].velocity_deg_s[k];
        return sum;
    };
    double work = 0.0;
    const std::size_t last = motions.front().size() - 1;
    for (std::size_t k = 0; k < last; ++k) work += 0.5 * (power(k) + power(k + 1)) * 0.001;
    CHECK(std::abs(work) > 0.5);
    CHECK_THAT(work, WithinAbs(energy(last) - energy(0), 2e-4));
}

TEST_CASE("columns times values are the torque, and links before the joint bring none", "[arm]") {
    const Chain chain = chain_of_mdh("panda.csv", panda_mdh);
    const auto links = random_links(7, 5);
    const auto motions = fourier_motions(7, 1.0, 100.0, 6);
    const auto columns = arm_columns(chain, motions, 4);
    REQUIRE(columns.size() == 70);
    std::vector<double> sum(100, 0.0);
    for (std::size_t c = 0; c < columns.size(); ++c)
        for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += links[c] * columns[c][k];
    CHECK(mean_difference(sum, arm_torque(chain, links, motions, 4)) < 1e-12);
    for (std::size_t c = 0; c < 40; ++c) CHECK(columns[c] == std::vector<double>(100, 0.0));
}

TEST_CASE("a Panda has 43 values, which is what those who identified it count", "[arm]") {
    // Gaz, Cognetti, Oliva, Robuffo Giordano, De Luca: Dynamic Identification of the Franka Emika Panda Robot
    // With Retrieval of Feasible Parameters, 2019, section III.
    const Chain chain = chain_of_mdh("panda.csv", panda_mdh);
    CHECK(arm_values_there(chain) == 43);
    std::vector<std::size_t> each;
    for (std::size_t j = 0; j < 7; ++j) each.push_back(arm_values_there(chain, j));
    CHECK(each == std::vector<std::size_t>{38, 42, 35, 28, 21, 14, 7});
    // About the first joint the links' inertia is a rotor's; about the third it is not.
    CHECK_FALSE(rotor_is_identifiable(chain, 0));
    CHECK(rotor_is_identifiable(chain, 2));
}

TEST_CASE("a joint that is kept still is part of the link before", "[arm]") {
    const Chain chain = random_chain(4, 31, false);
    const Chain still = hold_joint(chain, "j2", 30.0);
    REQUIRE(still.size() == 3);
    auto motions = fourier_motions(4, 1.0, 50.0, 32);
    motions[1].position_deg.assign(50, 30.0);
    motions[1].velocity_deg_s.assign(50, 0.0);
    motions[1].acceleration_deg_s2.assign(50, 0.0);
    auto links = random_links(4, 33);
    std::fill_n(links.begin() + 10, 10, 0.0);
    const auto torque_nm = arm_torque(chain, links, motions, 0);
    links.erase(links.begin() + 10, links.begin() + 20);
    motions.erase(motions.begin() + 1);
    CHECK(mean_difference(arm_torque(still, links, motions, 0), torque_nm) < 1e-11);
    CHECK_THROWS_WITH(hold_joint(chain, "j22", 0.0), Catch::Contains("did you mean j2"));
}

TEST_CASE("an arm is told how many motions it needs", "[arm]") {
    const Chain chain = random_chain(3, 1, false);
    CHECK_THROWS_AS(arm_columns(chain, fourier_motions(2, 1.0, 10.0, 1), 0), UsageError);
    CHECK_THROWS_AS(arm_columns(chain, fourier_motions(3, 1.0, 10.0, 1), 3), UsageError);
    CHECK_THROWS_AS(arm_torque(chain, std::vector<double>(29), fourier_motions(3, 1.0, 10.0, 1), 0),
                    UsageError);
}
