<?xml version="1.0" encoding="utf-8"?>
<!DOCTYPE TS>
<TS version="2.1" language="es_ES" sourcelanguage="en_US">
<context>
    <name>AIFRecon</name>
    <message>
        <source>AI model:</source>
        <translation>Modelo de IA:</translation>
    </message>
    <message>
        <source>AI models (*.onnx)</source>
        <translation>Modelos de IA (*.onnx)</translation>
    </message>
    <message>
        <source>AI output:</source>
        <translation>Resultado de IA:</translation>
    </message>
    <message>
        <source>AI stream:</source>
        <translation>Flujo de IA:</translation>
    </message>
    <message>
        <source>An AI model (a neural network) that says where bone is in a frame, as an ONNX file. It is run on this computer's processor, and nothing but this file and the JSON of its name is opened.</source>
        <translation>Un modelo de IA (una red neuronal) que dice dónde hay hueso en una imagen, como archivo ONNX. Se ejecuta en el procesador de este ordenador, y solo se abren este archivo y el JSON de su nombre.</translation>
    </message>
    <message>
        <source>Bone of CT:</source>
        <translation>Hueso de la TC:</translation>
    </message>
    <message>
        <source>Bone told by:</source>
        <translation>Hueso según:</translation>
    </message>
    <message>
        <source>CT:</source>
        <translation>TC:</translation>
    </message>
    <message>
        <source>Connection</source>
        <translation>Conexión</translation>
    </message>
    <message>
        <source>Live</source>
        <translation>En directo</translation>
    </message>
    <message>
        <source>More</source>
        <translation>Más</translation>
    </message>
    <message>
        <source>More sweeps:</source>
        <translation>Más barridos:</translation>
    </message>
    <message>
        <source>Name under which the server sends what an AI model says (device), with the time stamps of its images</source>
        <translation>Nombre con el que el servidor envía lo que dice un modelo de IA (dispositivo), con las marcas de tiempo de sus imágenes</translation>
    </message>
    <message>
        <source>None</source>
        <translation>Ninguno</translation>
    </message>
    <message>
        <source>None yet</source>
        <translation>Todavía ninguno</translation>
    </message>
    <message>
        <source>Open recording, CT, segmentation...</source>
        <translation>Abrir grabación, TC, segmentación...</translation>
    </message>
    <message>
        <source>Pause</source>
        <translation>Pausa</translation>
    </message>
    <message>
        <source>Place CT on sweep</source>
        <translation>Colocar la TC sobre el barrido</translation>
    </message>
    <message>
        <source>Reconstruct</source>
        <translation>Reconstruir</translation>
    </message>
    <message>
        <source>Record</source>
        <translation>Grabar</translation>
    </message>
    <message>
        <source>Recorded</source>
        <translation>Grabado</translation>
    </message>
    <message>
        <source>Say where to move next</source>
        <translation>Decir adónde mover</translation>
    </message>
    <message>
        <source>Settings</source>
        <translation>Ajustes</translation>
    </message>
    <message>
        <source>Start</source>
        <translation>Iniciar</translation>
    </message>
    <message>
        <source>Start over...</source>
        <translation>Empezar de nuevo...</translation>
    </message>
    <message>
        <source>Stop</source>
        <translation>Detener</translation>
    </message>
    <message>
        <source>Sweep and CT</source>
        <translation>Barrido y TC</translation>
    </message>
    <message>
        <source>Sweep:</source>
        <translation>Barrido:</translation>
    </message>
    <message>
        <source>Try it on a sample patient</source>
        <translation>Probar con un paciente de muestra</translation>
    </message>
    <message>
        <source>Use the scanned area</source>
        <translation>Usar la zona explorada</translation>
    </message>
    <message>
        <source>Vertebrae:</source>
        <translation>Vértebras:</translation>
    </message>
    <message>
        <source>What an AI model has said of the frames (predictions): a sequence of images, one for each frame or with their times, from 0 to 255 or from 0 to 1</source>
        <translation>Lo que un modelo de IA ha dicho de las imágenes (predicciones): una secuencia de imágenes, una por cada imagen o con sus tiempos, de 0 a 255 o de 0 a 1</translation>
    </message>
    <message>
        <source>Who says where bone is: the CT in its place, an AI model (a neural network) that looks at every frame, or the echoes, bright with darkness behind them. Only the CT knows bone that no frame shows.</source>
        <translation>Quién dice dónde hay hueso: la TC en su sitio, un modelo de IA (una red neuronal) que mira cada imagen, o los ecos, brillantes con oscuridad detrás. Solo la TC conoce el hueso que ninguna imagen muestra.</translation>
    </message>
    <message>
        <source>not started</source>
        <translation>no iniciado</translation>
    </message>
</context>
<context>
    <name>AIFReconGui.packages</name>
    <message>
        <source>An AI model in a file needs the Python package onnxruntime, a download from the internet. Install it now?</source>
        <translation>Un modelo de IA en un archivo necesita el paquete de Python onnxruntime, que se descarga de Internet. ¿Instalarlo ahora?</translation>
    </message>
</context>
<context>
    <name>AIFReconLib</name>
    <message>
        <source>Bone is known from {looked} of {frames} frames.</source>
        <translation>El hueso se conoce por {looked} de {frames} imágenes.</translation>
    </message>
    <message>
        <source>CT agrees but for {bones}: {found}</source>
        <translation>La TC concuerda salvo en {bones}: {found}</translation>
    </message>
    <message>
        <source>CT agrees: {found}</source>
        <translation>La TC concuerda: {found}</translation>
    </message>
    <message>
        <source>CT does not agree: {found}</source>
        <translation>La TC no concuerda: {found}</translation>
    </message>
    <message>
        <source>Do not trust the picture there, nor the names of the levels: the spine may have bent since the CT, or the CT lies one level off.</source>
        <translation>No se fíe allí de la imagen ni de los nombres de los niveles: la columna puede haberse curvado desde la TC, o la TC está desplazada un nivel.</translation>
    </message>
    <message>
        <source>Move the probe more slowly: {fast:.0f} mm/s at most.</source>
        <translation>Mueva la sonda más despacio: {fast:.0f} mm/s como mucho.</translation>
    </message>
    <message>
        <source>Place the CT on the sweep before you believe the picture.</source>
        <translation>Coloque la TC sobre el barrido antes de creer la imagen.</translation>
    </message>
    <message>
        <source>Scan {name} again, from other angles.</source>
        <translation>Explore de nuevo {name}, desde otros ángulos.</translation>
    </message>
    <message>
        <source>expected to show: {shares}</source>
        <translation>se espera ver: {shares}</translation>
    </message>
    <message>
        <source>known after “Reconstruct”</source>
        <translation>se sabrá tras «Reconstruir»</translation>
    </message>
    <message>
        <source>no sweep yet</source>
        <translation>todavía sin barrido</translation>
    </message>
    <message>
        <source>onnxruntime was not installed, and an AI model in a file needs it: {why}</source>
        <translation>onnxruntime no se instaló, y un modelo de IA en un archivo lo necesita: {why}</translation>
    </message>
    <message>
        <source>{count} predictions belong to no frame with a pose.</source>
        <translation>{count} predicciones no pertenecen a ninguna imagen con posición.</translation>
    </message>
    <message>
        <source>{frames}, probe at {speed:.0f} mm/s</source>
        <translation>{frames}, sonda a {speed:.0f} mm/s</translation>
    </message>
    <message>
        <source>{packages} is not installed, and an AI model in a file needs it.</source>
        <translation>{packages} no está instalado, y un modelo de IA en un archivo lo necesita.</translation>
    </message>
    <message>
        <source>{share:.0%} of the echoes lie on its bone, {median:.1f} mm off in the median</source>
        <translation>{share:.0%} de los ecos están sobre su hueso, a {median:.1f} mm en la mediana</translation>
    </message>
    <message>
        <source>{used} of {frames} frames</source>
        <translation>{used} de {frames} imágenes</translation>
    </message>
</context>
<context>
    <name>AIFReconScene.panelWords</name>
    <message>
        <source>The echoes themselves</source>
        <translation>Los propios ecos</translation>
    </message>
    <message>
        <source>The output of the AI model belongs to one sweep; got {predictions} for {sweeps}. Leave the others out.</source>
        <translation>El resultado del modelo de IA pertenece a un barrido; hay {predictions} para {sweeps}. Deje los demás fuera.</translation>
    </message>
    <message>
        <source>{name}: predictions of {got} pixels do not fit frames of {frames}. Select what the AI model has said of this sweep, in its size.</source>
        <translation>{name}: predicciones de {got} píxeles no encajan con imágenes de {frames}. Elija lo que el modelo de IA ha dicho de este barrido, en su tamaño.</translation>
    </message>
</context>
<context>
    <name>Picture</name>
    <message>
        <source>Research use only: not for guiding a needle.</source>
        <translation>Solo para investigación: no para guiar una aguja.</translation>
    </message>
</context>
<context>
    <name>inputs.boneSource</name>
    <message>
        <source>An AI model in a file</source>
        <translation>Un modelo de IA en un archivo</translation>
    </message>
    <message>
        <source>An AI model that runs elsewhere</source>
        <translation>Un modelo de IA que se ejecuta en otro sitio</translation>
    </message>
    <message>
        <source>An AI model, as it was recorded</source>
        <translation>Un modelo de IA, tal como se grabó</translation>
    </message>
    <message>
        <source>Bone is looked for in the sweep itself: what is bright with darkness behind it. The docs say how well that works.</source>
        <translation>El hueso se busca en el propio barrido: lo que brilla con oscuridad detrás. La documentación dice lo bien que funciona.</translation>
    </message>
    <message>
        <source>Choose the file of the AI model, or choose another “Bone told by”.</source>
        <translation>Elija el archivo del modelo de IA, u otro «Hueso según».</translation>
    </message>
    <message>
        <source>Enter the name under which the server sends what the AI model says, or choose another “Bone told by”.</source>
        <translation>Escriba el nombre con el que el servidor envía lo que dice el modelo de IA, o elija otro «Hueso según».</translation>
    </message>
    <message>
        <source>Every label above 0 is bone.</source>
        <translation>Toda etiqueta mayor que 0 es hueso.</translation>
    </message>
    <message>
        <source>Images and what the AI model says of them must have two names; both are {name}.</source>
        <translation>Las imágenes y lo que el modelo de IA dice de ellas deben tener dos nombres; ambos son {name}.</translation>
    </message>
    <message>
        <source>No bone selected: the sweep is averaged, and bone is not enhanced.</source>
        <translation>Ningún hueso elegido: el barrido se promedia y el hueso no se realza.</translation>
    </message>
    <message>
        <source>Select the recorded output of the AI model, or choose another “Bone told by”.</source>
        <translation>Elija el resultado grabado del modelo de IA, u otro «Hueso según».</translation>
    </message>
    <message>
        <source>Taken for the probability of bone, from 0 to 1.</source>
        <translation>Se toma como probabilidad de hueso, de 0 a 1.</translation>
    </message>
    <message>
        <source>The CT</source>
        <translation>La TC</translation>
    </message>
    <message>
        <source>The echoes themselves</source>
        <translation>Los propios ecos</translation>
    </message>
    <message>
        <source>The output of the AI model belongs to one sweep: leave the others out, or choose another “Bone told by”.</source>
        <translation>El resultado del modelo de IA pertenece a un barrido: deje los demás fuera, o elija otro «Hueso según».</translation>
    </message>
    <message>
        <source>There is no file {path}.</source>
        <translation>No hay ningún archivo {path}.</translation>
    </message>
    <message>
        <source>What an AI model says comes from a server: take the images from there too, or choose another “Bone told by”.</source>
        <translation>Lo que dice un modelo de IA viene de un servidor: tome también de allí las imágenes, o elija otro «Hueso según».</translation>
    </message>
</context>
<context>
    <name>inputs.readiness</name>
    <message>
        <source>Open a recording, or select a tracked sweep.</source>
        <translation>Abra una grabación o elija un barrido.</translation>
    </message>
</context>
<context>
    <name>panel.lights</name>
    <message>
        <source>Coverage</source>
        <translation>Cobertura</translation>
    </message>
    <message>
        <source>Registration</source>
        <translation>Registro</translation>
    </message>
    <message>
        <source>Tracking</source>
        <translation>Seguimiento</translation>
    </message>
    <message>
        <source>being worked out ...</source>
        <translation>se está calculando...</translation>
    </message>
</context>
<context>
    <name>panel.livePanel</name>
    <message>
        <source>Press Start</source>
        <translation>Pulse Iniciar</translation>
    </message>
    <message>
        <source>What the AI model said is in {path}.</source>
        <translation>Lo que dijo el modelo de IA está en {path}.</translation>
    </message>
    <message>
        <source>not started</source>
        <translation>no iniciado</translation>
    </message>
    <message>
        <source>stopped</source>
        <translation>detenido</translation>
    </message>
</context>
<context>
    <name>panel.liveWords</name>
    <message>
        <source>Bring what is not seen into the tracker's view</source>
        <translation>Ponga a la vista del rastreador lo que no se ve</translation>
    </message>
    <message>
        <source>Keep scanning</source>
        <translation>Siga explorando</translation>
    </message>
    <message>
        <source>Probe seen</source>
        <translation>Sonda vista</translation>
    </message>
</context>
<context>
    <name>panel.recordedPanel</name>
    <message>
        <source>Done.</source>
        <translation>Hecho.</translation>
    </message>
    <message>
        <source>Sweep and CT</source>
        <translation>Barrido y TC</translation>
    </message>
    <message>
        <source>Sweep and CT: {names}</source>
        <translation>Barrido y TC: {names}</translation>
    </message>
</context>
<context>
    <name>panel.signals</name>
    <message>
        <source>caution</source>
        <translation>precaución</translation>
    </message>
    <message>
        <source>good</source>
        <translation>bien</translation>
    </message>
    <message>
        <source>not yet</source>
        <translation>aún no</translation>
    </message>
    <message>
        <source>poor</source>
        <translation>mal</translation>
    </message>
</context>
<context>
    <name>picture.sweepPage</name>
    <message>
        <source>Research use only: not for guiding a needle.</source>
        <translation>Solo para investigación: no para guiar una aguja.</translation>
    </message>
</context>
</TS>
