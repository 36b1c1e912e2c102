// Where the samples of the sensors go.
#pragma once

#include "core/base/cloud.hpp"
#include "core/base/samples.hpp"

namespace crspf {

/// Samples are valid during the call only.
class SampleSink {
 public:
    virtual ~SampleSink() = default;
    virtual void on_scan(const Scan& scan) = 0;
    /// A complete revolution, where the configuration wants it whole.
    virtual void on_cloud(const Cloud& cloud) = 0;
    virtual void on_wheel(const DifferentialSample& sample) = 0;
    virtual void on_wheel(const AckermannSample& sample) = 0;
    virtual void on_imu(const ImuSample& sample) = 0;
    virtual void on_motion(const MotionSample& sample) = 0;
};

}  // namespace crspf
