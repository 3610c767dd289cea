<?xml version="1.0" encoding="utf-8"?>
<!DOCTYPE TS>
<TS version="2.1" language="zh_CN" sourcelanguage="en_US">
<context>
    <name>AIFRecon</name>
    <message>
        <source>A network that says where bone is in a frame, as an ONNX file. It is run on this computer's processor, and nothing but this file and the JSON of its name is opened.</source>
        <translation>说明一帧中骨骼位置的网络（ONNX 文件）。它在本机处理器上运行，除此文件和同名 JSON 外不打开任何文件。</translation>
    </message>
    <message>
        <source>And also:</source>
        <translation>以及：</translation>
    </message>
    <message>
        <source>Bone from:</source>
        <translation>骨骼依据：</translation>
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
        <source>Name under which the server sends what a network says (device), with the time stamps of its images</source>
        <translation>服务器发送网络结果所用的名称（设备），带有相应图像的时间戳</translation>
    </message>
    <message>
        <source>Network name:</source>
        <translation>网络名称：</translation>
    </message>
    <message>
        <source>Network said:</source>
        <translation>网络的结果：</translation>
    </message>
    <message>
        <source>Network:</source>
        <translation>网络：</translation>
    </message>
    <message>
        <source>Networks (*.onnx)</source>
        <translation>网络 (*.onnx)</translation>
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
        <source>What a network has said of the frames (predictions): a sequence of images, one for each frame or with their times, from 0 to 255 or from 0 to 1</source>
        <translation>网络对各帧的判断（预测）：一个图像序列，每帧一幅或带有各帧的时间，取值 0 到 255 或 0 到 1</translation>
    </message>
    <message>
        <source>Who says where bone is: the CT in its place, a neural network that looks at every frame, or the echoes, bright with darkness behind them. Only the CT knows bone that no frame shows.</source>
        <translation>由谁说明骨骼在哪里：已就位的 CT、逐帧查看图像的神经网络，或后方变暗的明亮回声。只有 CT 知道任何一帧都没有显示的骨骼。</translation>
    </message>
    <message>
        <source>not started</source>
        <translation>未开始</translation>
    </message>
</context>
<context>
    <name>AIFReconGui.packages</name>
    <message>
        <source>A network in a file needs the Python package onnxruntime. Install it now?</source>
        <translation>文件中的网络需要 Python 包 onnxruntime。现在安装吗？</translation>
    </message>
</context>
<context>
    <name>AIFReconLib</name>
    <message>
        <source>Bone is known from {looked} of {frames} frames.</source>
        <translation>已由 {frames} 帧中的 {looked} 帧得知骨骼。</translation>
    </message>
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
        <source>onnxruntime was not installed, and a network in a file needs it: {why}</source>
        <translation>未安装 onnxruntime，而文件中的网络需要它：{why}</translation>
    </message>
    <message>
        <source>told after the reconstruction</source>
        <translation>重建后给出</translation>
    </message>
    <message>
        <source>{count} predictions belong to no frame with a pose.</source>
        <translation>{count} 个预测不属于任何有位姿的帧。</translation>
    </message>
    <message>
        <source>{frames}, {speed:.0f} mm/s</source>
        <translation>{frames}，{speed:.0f} mm/s</translation>
    </message>
    <message>
        <source>{packages} is not installed, and a network in a file needs it.</source>
        <translation>{packages} 未安装，而文件中的网络需要它。</translation>
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
    <name>AIFReconScene.panelWords</name>
    <message>
        <source>The echoes themselves</source>
        <translation>回声本身</translation>
    </message>
    <message>
        <source>What the network has said belongs to one sweep; got {predictions} for {sweeps}. Leave the others out.</source>
        <translation>网络的结果只属于一次扫查；现有 {predictions} 个对应 {sweeps} 次。请不选其他扫查。</translation>
    </message>
    <message>
        <source>{name}: predictions of {got} pixels do not fit frames of {frames}. Select what the network has said of this sweep, in its size.</source>
        <translation>{name}：{got} 像素的预测与 {frames} 的图像不符。请选择网络对此扫查、同样大小的结果。</translation>
    </message>
</context>
<context>
    <name>inputs.boneSource</name>
    <message>
        <source>A network in a file</source>
        <translation>文件中的网络</translation>
    </message>
    <message>
        <source>A network that runs elsewhere</source>
        <translation>在别处运行的网络</translation>
    </message>
    <message>
        <source>A network, as it was recorded</source>
        <translation>网络（已记录的结果）</translation>
    </message>
    <message>
        <source>Bone is looked for in the sweep itself: what is bright with darkness behind it. The docs say how well that works.</source>
        <translation>在扫查图像中寻找骨骼：明亮且后方变暗之处。文档说明了其效果。</translation>
    </message>
    <message>
        <source>Choose the file of the network, or let something else tell where bone is.</source>
        <translation>请选择网络文件，或改用其他骨骼依据。</translation>
    </message>
    <message>
        <source>Enter the name under which the server sends what the network says, or let something else tell where bone is.</source>
        <translation>请输入服务器发送网络结果所用的名称，或改用其他骨骼依据。</translation>
    </message>
    <message>
        <source>Every label above 0 is bone.</source>
        <translation>大于 0 的标签均为骨骼。</translation>
    </message>
    <message>
        <source>Images and what the network says of them must have two names; both are {name}.</source>
        <translation>图像与网络对其的结果必须使用两个名称；现在都是 {name}。</translation>
    </message>
    <message>
        <source>Select what the network has said of the sweep, or let something else tell where bone is.</source>
        <translation>请选择网络对此扫查的结果，或改用其他骨骼依据。</translation>
    </message>
    <message>
        <source>Taken for the probability of bone, from 0 to 1.</source>
        <translation>视为骨骼概率，取值 0 到 1。</translation>
    </message>
    <message>
        <source>The CT</source>
        <translation>CT</translation>
    </message>
    <message>
        <source>The echoes themselves</source>
        <translation>回声本身</translation>
    </message>
    <message>
        <source>There is no file {path}.</source>
        <translation>没有文件 {path}。</translation>
    </message>
    <message>
        <source>What a network says comes from a server: take the images from there too, or let something else tell where bone is.</source>
        <translation>网络的结果来自服务器：图像也请取自该服务器，或改用其他骨骼依据。</translation>
    </message>
    <message>
        <source>What the network has said belongs to one sweep: leave the others out, or let something else tell where bone is.</source>
        <translation>网络的结果只属于一次扫查：请不选其他扫查，或改用其他骨骼依据。</translation>
    </message>
    <message>
        <source>Without bone the sweep is averaged: nothing says at which angle a beam meets it.</source>
        <translation>没有骨骼时只做平均：无从得知声束以何角度到达。</translation>
    </message>
</context>
<context>
    <name>inputs.readiness</name>
    <message>
        <source>Select a tracked sweep, or load a recording.</source>
        <translation>请选择扫查，或载入录像。</translation>
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
        <source>What the network said is in {path}.</source>
        <translation>网络的结果在 {path}。</translation>
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
