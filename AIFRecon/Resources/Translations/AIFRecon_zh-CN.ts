<?xml version="1.0" encoding="utf-8"?>
<!DOCTYPE TS>
<TS version="2.1" language="zh_CN" sourcelanguage="en_US">
<context>
    <name>AIFRecon</name>
    <message>
        <source>And also:</source>
        <translation>以及：</translation>
    </message>
    <message>
        <source>Bone:</source>
        <translation>骨骼：</translation>
    </message>
    <message>
        <source>CT:</source>
        <translation>CT：</translation>
    </message>
    <message>
        <source>Connection</source>
        <translation>连接</translation>
    </message>
    <message>
        <source>Live</source>
        <translation>实时</translation>
    </message>
    <message>
        <source>More</source>
        <translation>更多</translation>
    </message>
    <message>
        <source>None</source>
        <translation>无</translation>
    </message>
    <message>
        <source>None (plain average)</source>
        <translation>无（普通平均）</translation>
    </message>
    <message>
        <source>None yet</source>
        <translation>暂无</translation>
    </message>
    <message>
        <source>Open recording, CT, segmentation...</source>
        <translation>打开录像、CT、分割……</translation>
    </message>
    <message>
        <source>Pause</source>
        <translation>暂停</translation>
    </message>
    <message>
        <source>Place CT on sweep</source>
        <translation>将 CT 对到扫查上</translation>
    </message>
    <message>
        <source>Reconstruct</source>
        <translation>重建</translation>
    </message>
    <message>
        <source>Record</source>
        <translation>录制</translation>
    </message>
    <message>
        <source>Recorded</source>
        <translation>已录制</translation>
    </message>
    <message>
        <source>Say where to move next</source>
        <translation>提示下一步移动</translation>
    </message>
    <message>
        <source>Settings</source>
        <translation>设置</translation>
    </message>
    <message>
        <source>Start</source>
        <translation>开始</translation>
    </message>
    <message>
        <source>Start over...</source>
        <translation>重新开始……</translation>
    </message>
    <message>
        <source>Stop</source>
        <translation>停止</translation>
    </message>
    <message>
        <source>Sweep and CT</source>
        <translation>扫查与 CT</translation>
    </message>
    <message>
        <source>Sweep:</source>
        <translation>扫查：</translation>
    </message>
    <message>
        <source>Try it on a sample patient</source>
        <translation>用示例患者试一试</translation>
    </message>
    <message>
        <source>Use the scanned box</source>
        <translation>使用扫查区域</translation>
    </message>
    <message>
        <source>Vertebrae:</source>
        <translation>椎骨：</translation>
    </message>
    <message>
        <source>not started</source>
        <translation>未开始</translation>
    </message>
</context>
<context>
    <name>AIFReconLib</name>
    <message>
        <source>CT agrees: {found}</source>
        <translation>CT 吻合：{found}</translation>
    </message>
    <message>
        <source>CT does not agree: {found}</source>
        <translation>CT 不吻合：{found}</translation>
    </message>
    <message>
        <source>Move the probe more slowly: {fast:.0f} mm/s at most.</source>
        <translation>请放慢探头：最多 {fast:.0f} mm/s。</translation>
    </message>
    <message>
        <source>Place the CT on the sweep before you believe the picture.</source>
        <translation>请先将 CT 对到扫查上，再相信图像。</translation>
    </message>
    <message>
        <source>Scan {name} again, from other angles.</source>
        <translation>请从其他角度再次扫查 {name}。</translation>
    </message>
    <message>
        <source>no sweep yet</source>
        <translation>尚无扫查</translation>
    </message>
    <message>
        <source>told after the reconstruction</source>
        <translation>重建后给出</translation>
    </message>
    <message>
        <source>{frames}, {speed:.0f} mm/s</source>
        <translation>{frames}，{speed:.0f} mm/s</translation>
    </message>
    <message>
        <source>{share:.0%} of the echoes, {median:.1f} mm</source>
        <translation>{share:.0%} 的回波，{median:.1f} mm</translation>
    </message>
    <message>
        <source>{used} of {frames} frames</source>
        <translation>{frames} 帧中的 {used} 帧</translation>
    </message>
</context>
<context>
    <name>inputs.readiness</name>
    <message>
        <source>Select a tracked sweep, or load a recording.</source>
        <translation>请选择扫查，或载入录像。</translation>
    </message>
    <message>
        <source>Without bone the sweep is averaged: nothing says at which angle a beam meets it.</source>
        <translation>没有骨骼时只做平均：无从得知声束以何角度到达。</translation>
    </message>
</context>
<context>
    <name>panel.lights</name>
    <message>
        <source>Coverage</source>
        <translation>覆盖</translation>
    </message>
    <message>
        <source>Registration</source>
        <translation>配准</translation>
    </message>
    <message>
        <source>Tracking</source>
        <translation>跟踪</translation>
    </message>
    <message>
        <source>being looked at ...</source>
        <translation>正在查看……</translation>
    </message>
</context>
<context>
    <name>panel.livePanel</name>
    <message>
        <source>Bring the probe into the tracker's view</source>
        <translation>请将探头移入跟踪器视野</translation>
    </message>
    <message>
        <source>Press Start</source>
        <translation>请按“开始”</translation>
    </message>
    <message>
        <source>Scan on</source>
        <translation>继续扫查</translation>
    </message>
    <message>
        <source>not started</source>
        <translation>未开始</translation>
    </message>
    <message>
        <source>stopped</source>
        <translation>已停止</translation>
    </message>
</context>
<context>
    <name>panel.recordedPanel</name>
    <message>
        <source>Done.</source>
        <translation>完成。</translation>
    </message>
    <message>
        <source>Sweep and CT</source>
        <translation>扫查与 CT</translation>
    </message>
    <message>
        <source>Sweep and CT: {names}</source>
        <translation>扫查与 CT：{names}</translation>
    </message>
</context>
<context>
    <name>panel.signals</name>
    <message>
        <source>good</source>
        <translation>良好</translation>
    </message>
    <message>
        <source>look</source>
        <translation>注意</translation>
    </message>
    <message>
        <source>not yet</source>
        <translation>尚无</translation>
    </message>
    <message>
        <source>poor</source>
        <translation>不良</translation>
    </message>
</context>
</TS>
