// SPDX-License-Identifier: MIT
// The list of rules holds every one, and each can be moved, within its bounds alone.
#include "ripplenotch/diagnose/rules.hpp"

#include <set>

#include "diagnose_fixture.hpp"
#include "ripplenotch/core/error.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using namespace ripplenotch::fixture;
using Catch::Contains;

TEST_CASE("every number of the rules is in their list, once, within its bounds, and says why it is there") {
    // All of them are numbers of 8 bytes side by side: one that is not listed leaves a gap.
    CHECK(sizeof(DiagnosisRules) == 8 * diagnosis_rules().size());
    std::set<std::string> names;
    for (const DiagnosisRule& rule : diagnosis_rules()) {
        CAPTURE(rule.name);
        CHECK(names.insert(rule.name).second);
        CHECK(rule.standard >= rule.lowest);
        CHECK(rule.standard <= rule.highest);
        CHECK(rule.lowest < rule.highest);
        CHECK(rule.why.size() > 10);
        CHECK(rule.why.back() == '.');
    }
    CHECK_NOTHROW(check(DiagnosisRules{}));
}

TEST_CASE("each rule is set by its name, alone, up to its bounds and not beyond") {
    for (const DiagnosisRule& rule : diagnosis_rules()) {
        CAPTURE(rule.name);
        for (const double bound : {rule.lowest, rule.highest}) {
            DiagnosisRules rules;
            rule.set(rules, bound);
            CHECK(rule.get(rules) == bound);
            CHECK_NOTHROW(check(rules));
            std::size_t moved = 0;
            for (const DiagnosisRule& other : diagnosis_rules())
                moved += other.get(rules) == other.standard ? 0U : 1U;
            CHECK(moved == (bound == rule.standard ? 0U : 1U));
        }
        DiagnosisRules rules;
        rule.set(rules, rule.whole ? rule.highest + 1.0 : 2.0 * rule.highest);
        CHECK_THROWS_WITH(check(rules), Contains(rule.name));
    }
}

TEST_CASE("a rule that does not exist, is no number, no count or out of bounds is refused by name") {
    DiagnosisRules rules;
    set_rule(rules, "doubt.least_elsewhere=0.35");
    CHECK(rules.doubt.least_elsewhere == 0.35);
    set_rule(rules, "search.most_names=3");
    CHECK(rules.search.most_names == 3);
    CHECK_THROWS_WITH(set_rule(rules, "doubt.least_elswhere=1"), Contains("'doubt.least_elsewhere'"));
    CHECK_THROWS_WITH(set_rule(rules, "search.most_names=2.5"), Contains("no whole number"));
    CHECK_THROWS_WITH(set_rule(rules, "search.most_names=-1"), Contains("search.most_names"));
    CHECK_THROWS_WITH(set_rule(rules, "search.most_names=few"), Contains("is no number"));
    CHECK_THROWS_WITH(set_rule(rules, "search.fair_part=nan"), Contains("search.fair_part"));
    CHECK_THROWS_AS(set_rule(rules, "search.fair_part"), UsageError);
    CHECK(rules.search.fair_part == DiagnosisRules{}.search.fair_part);
}

TEST_CASE("a diagnosis goes by the rules that it is given, and refuses those out of bounds") {
    Model truth = joint();
    truth.terms.push_back(parse_term("offset,torque_nm=0.4"));
    const Trace log = logged(truth, tour(), 3);
    const TraceView part = log.view().part(0, 3'000);
    DiagnosisOptions options;
    options.rules.judge.material_sigma = 10.0;  // the offset is eight times the noise
    CHECK(diagnose(opened(joint()), part, nullptr).named == std::vector<std::string>{"offset"});
    CHECK(diagnose(opened(joint()), part, nullptr, options).named.empty());
    options.rules.judge.material_sigma = -1.0;
    CHECK_THROWS_AS(diagnose(opened(joint()), part, nullptr, options), UsageError);
}
