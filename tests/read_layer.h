#pragma once
// A vector file as GDAL reads it.
#include <ogrsf_frmts.h>

#include <filesystem>

#include "catch.h"
#include "read_back.h"

/// A layer of a vector file: the one that it has, or that of the name.
class Layer {
public:
    explicit Layer(const std::filesystem::path& file, const char* name = nullptr) {
        GDALAllRegister();
        dataset_.reset(GDALDataset::Open(file.c_str(), GDAL_OF_VECTOR));
        REQUIRE(dataset_);
        if (!name) REQUIRE(dataset_->GetLayerCount() == 1);
        layer_ = name ? dataset_->GetLayerByName(name) : dataset_->GetLayer(0);
        CAPTURE(name);
        REQUIRE(layer_ != nullptr);
        ++read_back.files;
    }
    OGRLayer& get() const { return *layer_; }

private:
    GDALDatasetUniquePtr dataset_;
    OGRLayer* layer_ = nullptr;
};
