#pragma once
// A vector file as GDAL reads it.
#include <ogrsf_frmts.h>

#include <filesystem>

#include "catch.h"
#include "read_back.h"

/// The one layer of a vector file.
class Layer {
public:
    explicit Layer(const std::filesystem::path& file) {
        GDALAllRegister();
        dataset_.reset(GDALDataset::Open(file.c_str(), GDAL_OF_VECTOR));
        REQUIRE(dataset_);
        REQUIRE(dataset_->GetLayerCount() == 1);
        ++read_back.files;
    }
    OGRLayer& get() const { return *dataset_->GetLayer(0); }

private:
    GDALDatasetUniquePtr dataset_;
};
