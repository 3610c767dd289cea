<?xml version="1.0" encoding="utf-8"?>
<!DOCTYPE TS>
<TS version="2.1" language="zh_CN" sourcelanguage="en_US">
<context>
    <name>AIFRecon</name>
    <message>
        <source>AI model:</source>
        <translation>AI 模型：</translation>
    </message>
    <message>
        <source>AI models (*.onnx)</source>
        <translation>AI 模型 (*.onnx)</translation>
    </message>
    <message>
        <source>AI output:</source>
        <translation>AI 结果：</translation>
    </message>
    <message>
        <source>AI stream:</source>
        <translation>AI 数据流：</translation>
    </message>
    <message>
        <source>An AI model (a neural network) that says where bone is in a frame, as an ONNX file. It is run on this computer's processor, and nothing but this file and the JSON of its name is opened.</source>
        <translation>说明一帧中骨骼位置的 AI 模型（神经网络，ONNX 文件）。它在本机处理器上运行，除此文件和同名 JSON 外不打开任何文件。</translation>
    </message>
    <message>
        <source>Bone of CT:</source>
        <translation>CT 的骨骼：</translation>
    </message>
    <message>
        <source>Bone told by:</source>
        <translation>骨骼依据：</translation>
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
        <source>More sweeps:</source>
        <translation>更多扫查：</translation>
    </message>
    <message>
        <source>Name under which the server sends what an AI model says (device), with the time stamps of its images</source>
        <translation>服务器发送 AI 模型结果所用的名称（设备），带有相应图像的时间戳</translation>
    </message>
    <message>
        <source>None</source>
        <translation>无</translation>
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
        <source>Use the scanned area</source>
        <translation>使用已扫查的区域</translation>
    </message>
    <message>
        <source>Vertebrae:</source>
        <translation>椎骨：</translation>
    </message>
    <message>
        <source>What an AI model has said of the frames (predictions): a sequence of images, one for each frame or with their times, from 0 to 255 or from 0 to 1</source>
        <translation>AI 模型对各帧的判断（预测）：一个图像序列，每帧一幅或带有各帧的时间，取值 0 到 255 或 0 到 1</translation>
    </message>
    <message>
        <source>Who says where bone is: the CT in its place, an AI model (a neural network) that looks at every frame, or the echoes, bright with darkness behind them. Only the CT knows bone that no frame shows.</source>
        <translation>由谁说明骨骼在哪里：已就位的 CT、逐帧查看图像的 AI 模型（神经网络），或后方变暗的明亮回声。只有 CT 知道任何一帧都没有显示的骨骼。</translation>
    </message>
    <message>
        <source>not started</source>
        <translation>未开始</translation>
    </message>
</context>
<context>
    <name>AIFReconGui.packages</name>
    <message>
        <source>An AI model in a file needs the Python package onnxruntime, a download from the internet. Install it now?</source>
        <translation>文件中的 AI 模型需要 Python 包 onnxruntime（从互联网下载）。现在安装吗？</translation>
    </message>
</context>
<context>
    <name>AIFReconLib</name>
    <message>
        <source>Bone is known from {looked} of {frames} frames.</source>
        <translation>已由 {frames} 帧中的 {looked} 帧得知骨骼。</translation>
    </message>
    <message>
        <source>CT agrees but for {bones}: {found}</source>
        <translation>除 {bones} 外 CT 吻合：{found}</translation>
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
        <source>Do not trust the picture there, nor the names of the levels: the spine may have bent since the CT, or the CT lies one level off.</source>
        <translation>该处的图像和节段名称都不可信：脊柱可能在 CT 之后弯曲，或 CT 偏了一个节段。</translation>
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
        <source>expected to show: {shares}</source>
        <translation>预计可见：{shares}</translation>
    </message>
    <message>
        <source>known after “Reconstruct”</source>
        <translation>按“重建”后可知</translation>
    </message>
    <message>
        <source>no sweep yet</source>
        <translation>尚无扫查</translation>
    </message>
    <message>
        <source>onnxruntime was not installed, and an AI model in a file needs it: {why}</source>
        <translation>未安装 onnxruntime，而文件中的 AI 模型需要它：{why}</translation>
    </message>
    <message>
        <source>{count} predictions belong to no frame with a pose.</source>
        <translation>{count} 个预测不属于任何有位姿的帧。</translation>
    </message>
    <message>
        <source>{frames}, probe at {speed:.0f} mm/s</source>
        <translation>{frames}，探头速度 {speed:.0f} mm/s</translation>
    </message>
    <message>
        <source>{packages} is not installed, and an AI model in a file needs it.</source>
        <translation>{packages} 未安装，而文件中的 AI 模型需要它。</translation>
    </message>
    <message>
        <source>{share:.0%} of the echoes lie on its bone, {median:.1f} mm off in the median</source>
        <translation>{share:.0%} 的回波落在其骨骼上，中位偏差 {median:.1f} mm</translation>
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
        <source>The output of the AI model belongs to one sweep; got {predictions} for {sweeps}. Leave the others out.</source>
        <translation>AI 模型的结果只属于一次扫查；现有 {predictions} 个对应 {sweeps} 次。请不选其他扫查。</translation>
    </message>
    <message>
        <source>{name}: predictions of {got} pixels do not fit frames of {frames}. Select what the AI model has said of this sweep, in its size.</source>
        <translation>{name}：{got} 像素的预测与 {frames} 的图像不符。请选择 AI 模型对此扫查、同样大小的结果。</translation>
    </message>
</context>
<context>
    <name>Picture</name>
    <message>
        <source>Research use only: not for guiding a needle.</source>
        <translation>仅供研究：不得用于引导穿刺针。</translation>
    </message>
</context>
<context>
    <name>inputs.boneSource</name>
    <message>
        <source>An AI model in a file</source>
        <translation>文件中的 AI 模型</translation>
    </message>
    <message>
        <source>An AI model that runs elsewhere</source>
        <translation>在别处运行的 AI 模型</translation>
    </message>
    <message>
        <source>An AI model, as it was recorded</source>
        <translation>AI 模型（已记录的结果）</translation>
    </message>
    <message>
        <source>Bone is looked for in the sweep itself: what is bright with darkness behind it. The docs say how well that works.</source>
        <translation>在扫查图像中寻找骨骼：明亮且后方变暗之处。文档说明了其效果。</translation>
    </message>
    <message>
        <source>Choose the file of the AI model, or choose another “Bone told by”.</source>
        <translation>请选择 AI 模型的文件，或改选其他“骨骼依据”。</translation>
    </message>
    <message>
        <source>Enter the name under which the server sends what the AI model says, or choose another “Bone told by”.</source>
        <translation>请输入服务器发送 AI 模型结果所用的名称，或改选其他“骨骼依据”。</translation>
    </message>
    <message>
        <source>Every label above 0 is bone.</source>
        <translation>大于 0 的标签均为骨骼。</translation>
    </message>
    <message>
        <source>Images and what the AI model says of them must have two names; both are {name}.</source>
        <translation>图像与 AI 模型对其的结果必须使用两个名称；现在都是 {name}。</translation>
    </message>
    <message>
        <source>No bone selected: the sweep is averaged, and bone is not enhanced.</source>
        <translation>未选择骨骼：只对扫查做平均，不增强骨骼。</translation>
    </message>
    <message>
        <source>Select the recorded output of the AI model, or choose another “Bone told by”.</source>
        <translation>请选择已记录的 AI 模型结果，或改选其他“骨骼依据”。</translation>
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
        <source>The output of the AI model belongs to one sweep: leave the others out, or choose another “Bone told by”.</source>
        <translation>AI 模型的结果只属于一次扫查：请不选其他扫查，或改选其他“骨骼依据”。</translation>
    </message>
    <message>
        <source>There is no file {path}.</source>
        <translation>没有文件 {path}。</translation>
    </message>
    <message>
        <source>What an AI model says comes from a server: take the images from there too, or choose another “Bone told by”.</source>
        <translation>AI 模型的结果来自服务器：图像也请取自该服务器，或改选其他“骨骼依据”。</translation>
    </message>
</context>
<context>
    <name>inputs.readiness</name>
    <message>
        <source>Open a recording, or select a tracked sweep.</source>
        <translation>请打开录像，或选择扫查。</translation>
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
        <source>being worked out ...</source>
        <translation>正在计算……</translation>
    </message>
</context>
<context>
    <name>panel.livePanel</name>
    <message>
        <source>Press Start</source>
        <translation>请按“开始”</translation>
    </message>
    <message>
        <source>What the AI model said is in {path}.</source>
        <translation>AI 模型的结果在 {path}。</translation>
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
    <name>panel.liveWords</name>
    <message>
        <source>Bring what is not seen into the tracker's view</source>
        <translation>请将未被看到的部分移入跟踪器视野</translation>
    </message>
    <message>
        <source>Keep scanning</source>
        <translation>继续扫查</translation>
    </message>
    <message>
        <source>Probe seen</source>
        <translation>已看到探头</translation>
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
        <source>caution</source>
        <translation>注意</translation>
    </message>
    <message>
        <source>good</source>
        <translation>良好</translation>
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
<context>
    <name>picture.sweepPage</name>
    <message>
        <source>Research use only: not for guiding a needle.</source>
        <translation>仅供研究：不得用于引导穿刺针。</translation>
    </message>
</context>
</TS>
