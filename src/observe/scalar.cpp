#include "observe/scalar.h"

#include <fmt/core.h>

#include "base/error.h"
#include "observe/file_arrays.h"

namespace frana {

std::optional<Scalar> find_scalar(const std::vector<Field>& fields, const std::string& name) {
    for (const Field& field : fields) {
        if (field.components == 1) {
            if (field.name == name) return Scalar{name, field.unit, field.data, field.count, 1};
            continue;
        }
        const std::vector<std::string> names = component_names(field);
        for (std::size_t c = 0; c < names.size(); ++c)
            if (name == field.name + "_" + names[c])
                return Scalar{name, field.unit, field.data + c, field.count, field.components};
    }
    return std::nullopt;
}

Scalar scalar(const std::vector<Field>& fields, const std::string& name, const char* whose) {
    if (const auto found = find_scalar(fields, name)) return *found;
    std::string there;
    for (const Field& field : fields) there += (there.empty() ? "" : ", ") + field.name;
    throw UserError(
        fmt::format("found no field \"{}\" of {}; expected one of {}; choose one of them", name, whose, there));
}

}  // namespace frana
