#include <iostream>

#include "frana_commands.h"
#include "scene/combinations.h"

namespace frana {

int describe_command(const DescribeOptions& options) {
    std::cout << (options.combinations ? describe_combinations()
                  : options.markdown   ? describe_in_markdown()
                                       : describe(options.key));
    return 0;
}

}  // namespace frana
