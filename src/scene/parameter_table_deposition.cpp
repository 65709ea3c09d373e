// The keys of [deposition]: what the flow leaves behind as bed.
#include "scene/parameter_makers.h"

namespace frana {

void add_deposition(Table& table) {
    using namespace rows;
    const char* const law = "deposition.law";
    table.push_back(choice(
        law, {"none", "rest"}, "none",
        "how the flow becomes bed. rest: particles that creep at most, where the flow has been as slow for `time`"));
    table.push_back(
        with(number("deposition.time", "s", not_negative, 10.0,
                    "at rest, after which material becomes bed; later flow runs over it as over other ground"),
             law, {"rest"}));
}

}  // namespace frana
