#include <iostream>

#include "frana_commands.h"
#include "scene/combinations.h"
#include "scene/parameter_ranges.h"

namespace frana {

int describe_command(const DescribeOptions& options) {
    std::cout << (options.combinations ? describe_combinations()
                  : options.parameters ? ranges_in_markdown()
                  : options.markdown   ? describe_in_markdown()
                                       : describe(options.key));
    return 0;
}

}  // namespace frana
