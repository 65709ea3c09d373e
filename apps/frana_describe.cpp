#include <iostream>

#include "frana_commands.h"
#include "scene/parameters.h"

namespace frana {

int describe_command(const std::string& key, bool markdown) {
    std::cout << (markdown ? describe_in_markdown() : describe(key));
    return 0;
}

}  // namespace frana
